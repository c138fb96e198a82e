"""Names of the client's methods. An operation that is not listed gets its group from its tag."""

from __future__ import annotations

import re
from dataclasses import dataclass

ROOT = ""
"""The group of the methods of the client itself."""
METHODS = {
    "create_clip": "clips.upload",
    "delete_audio": "clips.delete_audio",
    "delete_clip": "clips.delete",
    "list_clips": "clips.list",
    "start_import": "clips.upload_archive",
    "update_clip": "clips.update",
    "edit_clip": "clips.edit",
    "cancel_or_delete_job": "jobs.cancel",
    "list_files": "jobs.files",
    "list_jobs": "jobs.list",
    "search_motion": "search.motion",
    "search_parts": "search.parts",
    "search_pose": "search.pose",
    "search_words": "search.words",
    "recognize": "recognize",
    "synthesize": "synthesize",
    "list_models": "models.list",
    "request_fit": "models.fit",
    "update_model": "models.update",
    "list_persons": "labels.persons",
    "list_tasks": "labels.tasks",
    "list_words": "labels.words",
    "list_sources": "labels.sources",
    "list_licenses": "labels.licenses",
    "list_metadata": "labels.metadata",
    "list_folders": "labels.folders",
    "list_collections": "collections.list",
    "create_collection": "collections.create",
    "get_collection": "collections.get",
    "update_collection": "collections.update",
    "delete_collection": "collections.delete",
    "list_items": "collections.items",
    "add_items": "collections.add",
    "update_item": "collections.update_item",
    "remove_item": "collections.remove_item",
    "order_items": "collections.order",
    "export_collection_as_zip": "collections.export",
    "get_collection_statistics": "collections.statistics",
    "list_searches": "searches.list",
    "explain_search": "search.why",
    "save_search": "searches.save",
    "get_search": "searches.get",
    "update_search": "searches.update",
    "delete_search": "searches.delete",
    "run_search": "searches.hits",
    "get_new_hits": "searches.new_hits",
    "mark_search_seen": "searches.mark_seen",
    "get_label_tree": "labels.tree",
    "put_label_tree": "labels.put_tree",
    "list_measures": "curation.measures",
    "list_duplicates": "curation.duplicates",
    "dismiss_duplicates": "curation.dismiss_duplicates",
    "list_outliers": "curation.outliers",
    "accept_outlier": "curation.accept_outlier",
    "dismiss_outlier": "curation.dismiss_outlier",
    "list_webhooks": "webhooks.list",
    "create_webhook": "webhooks.create",
    "get_webhook": "webhooks.get",
    "update_webhook": "webhooks.update",
    "delete_webhook": "webhooks.delete",
    "test_webhook": "webhooks.test",
    "livez": "service.alive",
    "readyz": "service.ready",
    "get_status": "service.status",
    "list_audit": "service.audit",
}
GROUPS = {
    "clips": "Clips and everything that can be seen of one.",
    "jobs": "Jobs: work in the background.",
    "search": "Searches by example, by pose and by words.",
    "models": "Models that are fitted on the library.",
    "labels": "Persons, tasks, words, sources, licenses, metadata and folders of the library.",
    "curation": "Measures, near-duplicates and outliers: what keeps a library clean.",
    "studies": "Blind studies that compare low-dimensional motions.",
    "service": "The service itself.",
    "collections": "Named sets of clips or parts of clips.",
    "searches": "Saved searches.",
    "webhooks": "Webhooks: addresses that the service calls when a job ends.",
}
SUBJECTS = re.compile(r"^get_(?:clip_|job_)?")
WHOLE = {"get_clip": "clips.get", "get_job": "jobs.get"}


@dataclass(frozen=True)
class MethodName:
    """The name of a method and of its group; group: ROOT for a method of the client itself."""

    group: str
    name: str


def method_name(operation: str, tag: str) -> MethodName:
    """The method of an operation."""
    path = {**METHODS, **WHOLE}.get(operation)
    if path is None:
        path = f"{tag.replace('-', '_')}.{SUBJECTS.sub('', operation)}"
    group, _, name = path.rpartition(".")
    return MethodName(group, name)


def group_doc(group: str) -> str:
    """The docstring of a group."""
    return GROUPS.get(group, f"Calls about {group}.")
