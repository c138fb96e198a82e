"""Groups of methods. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from kinedex.calls import alignment as calls_alignment
from kinedex.calls import audit as calls_audit
from kinedex.calls import clip_annotations as calls_clip_annotations
from kinedex.calls import clip_views as calls_clip_views
from kinedex.calls import clips as calls_clips
from kinedex.calls import collections as calls_collections
from kinedex.calls import composed_search as calls_composed_search
from kinedex.calls import curation as calls_curation
from kinedex.calls import edits as calls_edits
from kinedex.calls import evaluations as calls_evaluations
from kinedex.calls import export as calls_export
from kinedex.calls import health as calls_health
from kinedex.calls import imports as calls_imports
from kinedex.calls import jobs as calls_jobs
from kinedex.calls import keyposes as calls_keyposes
from kinedex.calls import label_tree as calls_label_tree
from kinedex.calls import labels as calls_labels
from kinedex.calls import low_dimensional as calls_low_dimensional
from kinedex.calls import manifests as calls_manifests
from kinedex.calls import measures as calls_measures
from kinedex.calls import models as calls_models
from kinedex.calls import poses as calls_poses
from kinedex.calls import recognize as calls_recognize
from kinedex.calls import recordings as calls_recordings
from kinedex.calls import search as calls_search
from kinedex.calls import searches as calls_searches
from kinedex.calls import segments as calls_segments
from kinedex.calls import service as calls_service
from kinedex.calls import session as calls_session
from kinedex.calls import space as calls_space
from kinedex.calls import status as calls_status
from kinedex.calls import studies as calls_studies
from kinedex.calls import suggestions as calls_suggestions
from kinedex.calls import symbols as calls_symbols
from kinedex.calls import synthesize as calls_synthesize
from kinedex.calls import webhooks as calls_webhooks
from kinedex.methods import CallMethod, Group, ListMethod, SenderType


class Clips(Group[SenderType]):
    """Clips and everything that can be seen of one."""

    list = ListMethod(calls_clips.list_clips)
    upload = CallMethod(calls_clips.create_clip)
    get = CallMethod(calls_clips.get_clip)
    update = CallMethod(calls_clips.update_clip)
    delete = CallMethod(calls_clips.delete_clip)
    file = CallMethod(calls_clips.get_file)
    audio = CallMethod(calls_recordings.get_audio)
    delete_audio = CallMethod(calls_recordings.delete_audio)
    edit = CallMethod(calls_edits.edit_clip)
    motion = CallMethod(calls_clip_views.get_motion)
    motion_array = CallMethod(calls_clip_views.get_motion_array)
    descriptor = CallMethod(calls_clip_views.get_descriptor)
    thumbnail = CallMethod(calls_clip_views.get_thumbnail)
    self_similarity = CallMethod(calls_clip_views.get_self_similarity)
    motion_volume = CallMethod(calls_clip_views.get_motion_volume)
    alignment = CallMethod(calls_alignment.get_alignment)
    keyposes = CallMethod(calls_keyposes.get_keyposes)
    name_keyposes = CallMethod(calls_keyposes.name_keyposes)
    forget_named_keyposes = CallMethod(calls_keyposes.forget_named_keyposes)
    list_annotations = CallMethod(calls_clip_annotations.list_annotations)
    add_annotation = CallMethod(calls_clip_annotations.add_annotation)
    replace_annotations = CallMethod(calls_clip_annotations.replace_annotations)
    annotation_file = CallMethod(calls_clip_annotations.get_annotation_file)
    put_annotation_file = CallMethod(calls_clip_annotations.put_annotation_file)
    suggest_annotations = CallMethod(calls_clip_annotations.suggest_annotations)
    accept_annotations = CallMethod(calls_clip_annotations.accept_annotations)
    annotation = CallMethod(calls_clip_annotations.get_annotation)
    update_annotation = CallMethod(calls_clip_annotations.update_annotation)
    delete_annotation = CallMethod(calls_clip_annotations.delete_annotation)
    low_dimensional = CallMethod(calls_low_dimensional.get_low_dimensional)
    low_dimensional_array = CallMethod(calls_low_dimensional.get_low_dimensional_array)
    animation = CallMethod(calls_low_dimensional.get_animation)
    export = CallMethod(calls_export.get_export)
    upload_archive = CallMethod(calls_imports.start_import)
    start_demo_import = CallMethod(calls_imports.start_demo_import)
    symbol_motion = CallMethod(calls_symbols.get_symbol_motion)
    symbol_motion_array = CallMethod(calls_symbols.get_symbol_motion_array)
    suggest_words = CallMethod(calls_suggestions.suggest_words)
    accept_words = CallMethod(calls_suggestions.accept_words)
    segments = CallMethod(calls_segments.get_segments)


class JobsBase(Group[SenderType]):
    """Jobs: work in the background."""

    list = ListMethod(calls_jobs.list_jobs)
    get = CallMethod(calls_jobs.get_job)
    cancel = CallMethod(calls_jobs.cancel_or_delete_job)
    files = ListMethod(calls_jobs.list_files)


class Search(Group[SenderType]):
    """Searches by example, by pose and by words."""

    motion = CallMethod(calls_search.search_motion)
    words = CallMethod(calls_search.search_words)
    parts = CallMethod(calls_composed_search.search_parts)
    why = CallMethod(calls_composed_search.explain_search)
    pose = CallMethod(calls_poses.search_pose)
    space = CallMethod(calls_space.get_space)
    space_columns = CallMethod(calls_space.get_space_columns)


class Models(Group[SenderType]):
    """Models that are fitted on the library."""

    list = CallMethod(calls_models.list_models)
    update = CallMethod(calls_models.update_model)
    confusion = CallMethod(calls_models.get_confusion)
    list_confused_clips = CallMethod(calls_models.list_confused_clips)
    signatures = CallMethod(calls_models.get_signatures)
    eigenmotion = CallMethod(calls_models.get_eigenmotion)
    eigenmotion_array = CallMethod(calls_models.get_eigenmotion_array)
    fit = CallMethod(calls_models.request_fit)
    list_evaluations = ListMethod(calls_evaluations.list_evaluations)
    start_evaluation = CallMethod(calls_evaluations.start_evaluation)
    evaluation = CallMethod(calls_evaluations.get_evaluation)
    delete_evaluation = CallMethod(calls_evaluations.delete_evaluation)


class Labels(Group[SenderType]):
    """Persons, tasks, words, sources, licenses, metadata and folders of the library."""

    persons = ListMethod(calls_labels.list_persons)
    forget_person = CallMethod(calls_labels.forget_person)
    tasks = ListMethod(calls_labels.list_tasks)
    words = ListMethod(calls_labels.list_words)
    sources = ListMethod(calls_labels.list_sources)
    licenses = ListMethod(calls_labels.list_licenses)
    metadata = ListMethod(calls_labels.list_metadata)
    folders = ListMethod(calls_labels.list_folders)
    manifest = CallMethod(calls_manifests.get_manifest)
    annotation_table = CallMethod(calls_manifests.get_annotation_table)
    tree = CallMethod(calls_label_tree.get_label_tree)
    put_tree = CallMethod(calls_label_tree.put_label_tree)


class Curation(Group[SenderType]):
    """Measures, near-duplicates and outliers: what keeps a library clean."""

    measures = CallMethod(calls_measures.list_measures)
    duplicates = ListMethod(calls_curation.list_duplicates)
    dismiss_duplicates = CallMethod(calls_curation.dismiss_duplicates)
    outliers = CallMethod(calls_curation.list_outliers)
    accept_outlier = CallMethod(calls_curation.accept_outlier)
    dismiss_outlier = CallMethod(calls_curation.dismiss_outlier)


class Studies(Group[SenderType]):
    """Blind studies that compare low-dimensional motions."""

    list_pairs = ListMethod(calls_studies.list_pairs)
    draw_pair = CallMethod(calls_studies.draw_pair)
    pair = CallMethod(calls_studies.get_pair)
    delete_pair = CallMethod(calls_studies.delete_pair)
    pair_animation = CallMethod(calls_studies.get_pair_animation)
    pair_motion = CallMethod(calls_studies.get_pair_motion)
    pair_motion_array = CallMethod(calls_studies.get_pair_motion_array)
    vote = CallMethod(calls_studies.vote)
    tally = CallMethod(calls_studies.get_tally)


class Service(Group[SenderType]):
    """The service itself."""

    audit = ListMethod(calls_audit.list_audit)
    status = CallMethod(calls_status.get_status)
    session = CallMethod(calls_session.get_session)
    sign_in = CallMethod(calls_session.sign_in)
    sign_out = CallMethod(calls_session.sign_out)
    alive = CallMethod(calls_health.livez)
    ready = CallMethod(calls_health.readyz)
    metrics = CallMethod(calls_service.metrics)


class Collections(Group[SenderType]):
    """Named sets of clips or parts of clips."""

    list = ListMethod(calls_collections.list_collections)
    create = CallMethod(calls_collections.create_collection)
    get = CallMethod(calls_collections.get_collection)
    update = CallMethod(calls_collections.update_collection)
    delete = CallMethod(calls_collections.delete_collection)
    items = ListMethod(calls_collections.list_items)
    add = CallMethod(calls_collections.add_items)
    update_item = CallMethod(calls_collections.update_item)
    remove_item = CallMethod(calls_collections.remove_item)
    order = CallMethod(calls_collections.order_items)
    statistics = CallMethod(calls_collections.get_collection_statistics)
    export = CallMethod(calls_collections.export_collection_as_zip)


class Searches(Group[SenderType]):
    """Saved searches."""

    list = ListMethod(calls_searches.list_searches)
    save = CallMethod(calls_searches.save_search)
    get = CallMethod(calls_searches.get_search)
    update = CallMethod(calls_searches.update_search)
    delete = CallMethod(calls_searches.delete_search)
    hits = ListMethod(calls_searches.run_search)
    new_hits = CallMethod(calls_searches.get_new_hits)
    mark_seen = CallMethod(calls_searches.mark_search_seen)


class Webhooks(Group[SenderType]):
    """Webhooks: addresses that the service calls when a job ends."""

    list = CallMethod(calls_webhooks.list_webhooks)
    create = CallMethod(calls_webhooks.create_webhook)
    get = CallMethod(calls_webhooks.get_webhook)
    update = CallMethod(calls_webhooks.update_webhook)
    delete = CallMethod(calls_webhooks.delete_webhook)
    test = CallMethod(calls_webhooks.test_webhook)


class RootBase(Group[SenderType]):
    """All groups except jobs, and the methods of the client itself."""

    recognize = CallMethod(calls_recognize.recognize)
    synthesize = CallMethod(calls_synthesize.synthesize)
    synthesize_array = CallMethod(calls_synthesize.synthesize_array)

    def __init__(self, sender: SenderType) -> None:
        super().__init__(sender)
        self.clips = Clips(sender)
        self.search = Search(sender)
        self.models = Models(sender)
        self.labels = Labels(sender)
        self.curation = Curation(sender)
        self.studies = Studies(sender)
        self.service = Service(sender)
        self.collections = Collections(sender)
        self.searches = Searches(sender)
        self.webhooks = Webhooks(sender)
