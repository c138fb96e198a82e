"""A small lexicon of human movement, written for this project.

It has groups of words with the same meaning, and the kinds of each meaning. So a query also finds
clips with another word of the same meaning (*sprint* -> *run*). The likeness of two words is 1 for
the same word, .9 for the same meaning, .7 if one is a kind of the other, .5 if both are kinds of
the same meaning, and else 0.
"""

from __future__ import annotations

from functools import cache

SAME_MEANING, KIND_OF, SIBLINGS = 0.9, 0.7, 0.5

_MEANINGS = """
move locomote travel
walk stroll amble saunter wander pace
march parade
sneak tiptoe creep prowl stalk
limp hobble shuffle
stagger stumble totter reel wobble
step stride
sidestep sidewalk
backward backwards reverse
forward forwards ahead
run sprint dash race gallop rush
jog trot lope
jump leap spring bound vault
hop skip bounce
dive plunge
crawl scramble
climb clamber ascend
descend
turn rotate revolve pivot veer
spin twirl whirl pirouette
roll tumble somersault cartwheel flip
fall collapse drop slip trip
stand upright
sit seat perch
lie recline rest sleep
kneel genuflect
squat crouch
bend stoop lean
bow curtsy
rise arise
lunge
stretch extend reach
lift raise hoist heave
lower
carry haul lug
push shove press
pull drag tug yank
throw toss hurl fling pitch cast
catch grab grasp seize grip
hold clutch
give hand_over
take pick pick_up
put place lay_down
hit strike beat smash slap
punch jab box hook uppercut
kick boot punt
block parry dodge duck evade
fight combat spar brawl
martial martial_arts karate kung_fu judo taekwondo
slash cut slice chop hack
stab thrust
swordplay fence fencing sword
shoot fire aim
swing sway
shake tremble shiver
wave beckon
greet salute hello hi welcome
bye goodbye farewell byebye
call summon
point indicate gesture gesticulate
guide lead direct
respond reply answer react
nod
clap applaud
hug embrace cuddle
kiss
dance boogie groove
breakdance breakdancing breaking b_boy
salsa
waltz
ballet
tango
hip_hop hiphop
swim paddle
ride
row
drive steer
play
tennis
golf
baseball
basketball dribble
football soccer
sing
read
write
type typing
eat chew
drink sip
wash scrub
clean wipe
sweep broom mop
cook stir
dig shovel
knock tap
open
close shut
look watch gaze stare
search seek
think ponder
talk speak chat
laugh giggle
cry weep sob
exercise workout train
push_up press_up
sit_up crunch
jumping_jack star_jump
stop halt pause
start begin
hand palm
arm forearm
leg shin thigh
foot feet
knee
elbow
shoulder
head
hip waist pelvis
finger
left
right
both two
up upward upwards
down downward downwards
side sideways lateral
high
low
fast quick rapid swift hasty
slow leisurely
angry furious mad enraged cross
sad unhappy gloomy sorrowful depressed
happy glad cheerful joyful merry
proud
afraid scared fearful frightened
tired weary fatigued sleepy
exhausted worn_out drained
active energetic lively vigorous
old elderly aged senior
young youthful juvenile
childish childlike childishly kiddish
masculine manly male
feminine womanly female ladylike
drunk tipsy intoxicated
normal neutral ordinary usual plain
relaxed calm casual
strong powerful
weak feeble
heavy
light
"""

_KINDS = """
move: walk run jump crawl climb dance swim turn
walk: march sneak limp stagger step sidestep
run: jog
jump: hop dive
turn: spin roll
bend: bow squat lunge
lift: carry
hit: punch kick slash stab
fight: martial swordplay punch kick block
dance: breakdance salsa waltz ballet tango hip_hop
gesture: wave point nod clap bow
greet: wave bye
wave: bye
clean: wash sweep
tired: exhausted
sit: kneel
"""


@cache
def _meaning_of() -> dict[str, int]:
    """The number of the meaning of each word, which is its line in _MEANINGS."""
    return {
        word: number
        for number, line in enumerate(_MEANINGS.strip().splitlines())
        for word in line.split()
    }


@cache
def _broader() -> dict[int, frozenset[int]]:
    """For each meaning, the broader meanings of which it is a kind."""
    broader: dict[int, set[int]] = {}
    for line in _KINDS.strip().splitlines():
        broad, kinds = line.split(":")
        for kind in kinds.split():
            broader.setdefault(_meaning_of()[kind], set()).add(_meaning_of()[broad])
    return {kind: frozenset(broad) for kind, broad in broader.items()}


def is_known(word: str) -> bool:
    """Whether the lexicon has `word` (normalized)."""
    return word in _meaning_of()


def likeness(one: str, other: str) -> float:
    """The likeness in meaning of two normalized words: 0..1, symmetric, 0 for unknown words."""
    if one == other:
        return 1.0
    meaning = _meaning_of()
    if one not in meaning or other not in meaning:
        return 0.0
    a, b = meaning[one], meaning[other]
    if a == b:
        return SAME_MEANING
    above_a, above_b = _broader().get(a, frozenset()), _broader().get(b, frozenset())
    if a in above_b or b in above_a:
        return KIND_OF
    return 0.0 if above_a.isdisjoint(above_b - _too_broad()) else SIBLINGS


def is_kind(word: str, broad: str) -> bool:
    """Whether `word` has the meaning of `broad` or is a kind of it: a jog is a run, and a run is
    no jog."""
    meaning = _meaning_of()
    if word not in meaning or broad not in meaning:
        return word == broad
    own, other = meaning[word], meaning[broad]
    return own == other or other in _broader().get(own, frozenset())


def parent(word: str) -> str | None:
    """The first word with the meaning of `word`; for that one, the first of the broader meaning.

    None for the broadest meanings and for unknown words.
    """
    meaning = _meaning_of().get(word)
    if meaning is None:
        return None
    words = _first_words()
    if word != words[meaning]:
        return words[meaning]
    # a kind of several meanings goes under the one that the lexicon names first
    broader = min(_broader().get(meaning, frozenset()), default=None)
    return None if broader is None else words[broader]


@cache
def _first_words() -> dict[int, str]:
    """The first word of each meaning."""
    first: dict[int, str] = {}
    for word, number in _meaning_of().items():
        first.setdefault(number, word)
    return first


@cache
def _too_broad() -> frozenset[int]:
    """Meanings that are so broad that their kinds need not be similar: walking is not jumping."""
    return frozenset({_meaning_of()["move"]})
