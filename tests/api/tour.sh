#!/usr/bin/env bash
# A tour of the API with curl, while `make demo` serves the demo library:
#
#   bash tests/api/tour.sh [http://127.0.0.1:8000]
#
# Every call must succeed. In the end the library has the same clips and labels as before.
# The tour needs curl 7.82 or newer and Python 3. http://127.0.0.1:8000/docs describes every call.
set -euo pipefail

B=${1:-http://127.0.0.1:8000}
FOLDER=$(mktemp -d)
ADDED=()
cd "$FOLDER"

# Also if the tour is interrupted: delete the clips that it added, and its files.
clean() {
  for clip in "${ADDED[@]}"; do curl -s -o /dev/null -X DELETE "$B/v1/clips/$clip"; done
  rm -r "$FOLDER"
}
trap clean EXIT

# Print what comes next; call and print the answer; call and save the answer in a file.
say() { printf '\n# %s\n' "$*"; }
call() { curl -sS --fail-with-body -w '\n' "$@"; }
save() { curl -sS --fail-with-body -o "$1" -w '%{filename_effective}: %{size_download} bytes\n' "${@:2}"; }

# Print one value of an answer in JSON: `pick items.0.id`.
pick() {
  python3 -c '
import json, sys
value = json.load(sys.stdin)
for part in sys.argv[1].split("."):
    value = value[int(part) if part.isdigit() else part]
print(value)' "$1"
}

# Print the names of a job's events until it has ended.
follow() { call -N "$B/v1/jobs/$1/events" | grep '^event'; }

say "Which clips are there? fields= chooses what is shown. Take one of Ada's kicks."
call "$B/v1/clips?task=kick&limit=3&fields=name,person"
call "$B/v1/clips?not_task=kick&folder=ada&min_duration=3&limit=2&fields=name,task,duration"
ID=$(call "$B/v1/clips?person=ada&task=kick&limit=1&fields=id" | pick items.0.id)
HITS="fields=score,start,end,clip.name,clip.person"

say "Find similar motions; motions like a part of it (seconds), of one person, by another method."
call "$B/v1/search/motion?$HITS" --json "{\"clip_id\": \"$ID\", \"limit\": 3}"
call "$B/v1/search/motion?$HITS" --json "{\"clip_id\": \"$ID\", \"start\": 1, \"end\": 2.5,
  \"method\": \"dtw\", \"filter\": {\"person\": [\"bruno\"]}, \"limit\": 2}"

say "Search inside long clips; rank by a metric that was learned from the labels."
call "$B/v1/search/motion?$HITS" --json "{\"clip_id\": \"$ID\", \"start\": 1, \"end\": 2,
  \"scope\": \"windows\", \"limit\": 2}"
call "$B/v1/search/motion?$HITS" --json "{\"clip_id\": \"$ID\", \"method\": \"metric-task\", \"limit\": 2}"

say "Find clips with this pose, and its times: a moment of a clip, or 13 positions."
call "$B/v1/search/pose?fields=score,time,clip.name" --json "{\"clip_id\": \"$ID\", \"time\": 0.5, \"limit\": 2}"

say "Find motions like a file: it is analyzed, but not stored."
save query.bvh "$B/v1/clips/$ID/file"
call "$B/v1/search/motion?$HITS" -F file=@query.bvh -F limit=2

say "Find motions by words or a sentence; exclude words; use Takano's correlated space."
call "$B/v1/search/words?$HITS" --json '{"words": ["kick", "leg"], "limit": 2}'
call "$B/v1/search/words?$HITS" --json '{"words": ["somebody is strolling", "-kick"], "limit": 2}'
call "$B/v1/search/words?$HITS" --json '{"words": ["kick"], "mode": "cca", "limit": 2}'

say "Who is it, and what are they doing? Of a file, or of a stored clip by Vasilescu's signatures."
call "$B/v1/recognize" -F file=@query.bvh
call "$B/v1/recognize" --json "{\"clip_id\": \"$ID\", \"method\": \"signatures\"}" | pick task.label

say "Who moves alike? The signatures of persons, and an eigenmotion as frames."
MODEL=$(call "$B/v1/models" | python3 -c 'import json, sys
print(next(m["id"] for m in json.load(sys.stdin)["items"] if m["kind"] == "signatures"))')
call "$B/v1/models/$MODEL/signatures?eigenmotions=1&limit=1" | pick persons.items.0.name
call "$B/v1/models/$MODEL/eigenmotions/2/motion?deviations=2" | pick frame_rate

say "Synthesize a walk by the person of a clip, on their skeleton. Which clip is like it?"
save walk.json "$B/v1/synthesize" --json "{\"clip_ids\": [\"$ID\"], \"task\": \"walk\", \"bvh\": true}"
pick quality.nearest_clip.name <walk.json

say "A picture, an animation, keyposes, segments, and what compares the clip with others."
save kick.svg "$B/v1/clips/$ID/thumbnail.svg"
save moving.svg "$B/v1/clips/$ID/animation.svg"
call "$B/v1/clips/$ID/keyposes" | pick frames
call "$B/v1/clips/$ID/segments"
save descriptor.json "$B/v1/clips/$ID/descriptor"
save symbol.json "$B/v1/clips/$ID/symbol/motion"

say "Its positions as JSON or as float32; its motion from three dimensions."
save motion.json "$B/v1/clips/$ID/motion?fps=10&joints=roles"
save motion.f32 -H 'Accept: application/octet-stream' "$B/v1/clips/$ID/motion"
save three.json "$B/v1/clips/$ID/low-dimensional?dimensions=3"

say "Export it: glTF; BVH on the one skeleton for all clips at 25 Hz; joint angles as a table."
save kick.glb "$B/v1/clips/$ID/export?format=glb"
save kick.bvh "$B/v1/clips/$ID/export?format=bvh&skeleton=canonical&fps=25"
save angles.csv "$B/v1/clips/$ID/export?format=csv&content=angles"

say "What is in the library: labels, folders, words that begin so, a map, models, a manifest."
call "$B/v1/tasks?limit=3"
call "$B/v1/folders"
call "$B/v1/words?q=ki"
call "$B/v1/space?dimensions=3&limit=1"
call "$B/v1/models" | pick items.0.kind
save manifest.csv "$B/v1/manifest.csv"
call "$B/v1/status"

say "Upload a clip with labels and metadata, and follow the job that analyzes it."
sed 's/^Frame Time:.*/Frame Time: 0.02/' query.bvh >mine.bvh
call "$B/v1/clips" -F file=@mine.bvh -F person=me -F task=kick -F 'words=kick slow' \
  -F 'metadata={"condition": "tired"}' >created.json
MINE=$(pick clip.id <created.json)
ADDED+=("$MINE")
follow "$(pick job.id <created.json)"
call "$B/v1/clips?meta.condition=tired&fields=name,person,metadata"

say "Correct its labels, accept a suggested word, correct its frame rate: it is analyzed again."
call -X PATCH "$B/v1/clips/$MINE" --json '{"words": ["kick", "left_leg"], "metadata": {"age": 30}}' | pick words
call "$B/v1/clips/$MINE/word-suggestions"
call "$B/v1/clips/$MINE/word-suggestions/accept" --json '{"words": ["leg"]}' | pick words
call -X PATCH "$B/v1/clips/$MINE" --json '{"frame_rate": 60}' | pick reanalysis

say "Import a ZIP: one of its files is stored already. What happened to each file?"
sed 's/^Frame Time:.*/Frame Time: 0.025/' query.bvh >another.bvh
python3 -m zipfile -c clips.zip mine.bvh another.bvh
IMPORT=$(call "$B/v1/imports" -F archive=@clips.zip -F person=me | pick job.id)
follow "$IMPORT"
call "$B/v1/jobs/$IMPORT/files" >files.json
ADDED+=("$(pick items.0.clip_id <files.json)")
pick items.0.outcome <files.json
pick items.1.outcome <files.json

say "Delete the clips again, and fit the models (Kinedex also does this after many changes)."
for clip in "${ADDED[@]}"; do call -X DELETE "$B/v1/clips/$clip"; done
ADDED=()
follow "$(call -X POST "$B/v1/models/fit" | pick job.id)"

say "That was the tour."
