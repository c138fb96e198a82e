"""The tree of failures.

A failure is a class. The first line of its docstring is its title and its default detail; `code`
is its name for programs. Only `app.api` assigns HTTP statuses. Standard library only.
"""

from __future__ import annotations

from typing import Self

from app.kinedex_error import KinedexError


class BadContent(KinedexError):
    """The content cannot be used."""

    code = "bad_content"


class Unreadable(BadContent):
    """The file cannot be read as its format."""

    code = "unreadable"


class UnknownFormat(BadContent):
    """The content has no format that Kinedex can read."""

    code = "unknown_format"


class FormatNotSupported(BadContent):
    """The format is known, but this version cannot read it."""

    code = "format_not_supported"


class EmptyFile(BadContent):
    """The file is empty."""

    code = "empty_file"


class SkeletonNeeded(BadContent):
    """An AMC file moves the bones of an ASF file: send that as `skeleton`."""

    code = "skeleton_needed"


class MotionNeeded(BadContent):
    """An ASF file holds no motion: send the AMC file as `file` and this one as `skeleton`."""

    code = "motion_needed"


class SkeletonNotNeeded(BadContent):
    """A skeleton goes with an AMC file only."""

    code = "skeleton_not_needed"


class NotHuman(BadContent):
    """The skeleton lacks joints without which a body cannot be analyzed."""

    code = "skeleton_not_human"


class TooShort(BadContent):
    """The motion is too short to be analyzed."""

    code = "too_short"


class NoGait(BadContent):
    """The motion holds no walking that can be measured."""

    code = "no_gait"


class TooLarge(KinedexError):
    """The content is larger than the limit."""

    code = "too_large"


class AnalysisTimedOut(BadContent):
    """The analysis took longer than the limit and was stopped."""

    code = "analysis_timed_out"


class AnalysisCrashed(BadContent):
    """The analysis process died (out of memory, or killed)."""

    code = "analysis_crashed"


class AnalysisInterrupted(KinedexError):
    """The analysis process was stopped from outside; ask again shortly."""

    code = "analysis_interrupted"


class BadField(KinedexError):
    """A field of the request is wrong."""

    code = "bad_field"


class IdempotencyKeyReused(BadField):
    """This Idempotency-Key was used for a call with another body."""

    code = "idempotency_key_reused"


class NotFound(KinedexError):
    """There is nothing with this id or name."""

    code = "not_found"


class PageNotFound(NotFound):
    """There is no such page: the cursor is from another list or query."""

    code = "page_not_found"


class ClipNotFound(NotFound):
    """There is no clip with this id."""

    code = "clip_not_found"


class AnnotationNotFound(NotFound):
    """The clip has no annotation with this id."""

    code = "annotation_not_found"


class JobNotFound(NotFound):
    """There is no job with this id."""

    code = "job_not_found"


class EvaluationNotFound(NotFound):
    """There is no evaluation with this id."""

    code = "evaluation_not_found"


class WebhookNotFound(NotFound):
    """There is no webhook with this id."""

    code = "webhook_not_found"


class CollectionNotFound(NotFound):
    """There is no collection with this id."""

    code = "collection_not_found"


class SearchNotFound(NotFound):
    """There is no saved search with this id."""

    code = "search_not_found"


class StoredFileMissing(NotFound):
    """A stored file of this clip is missing."""

    code = "file_missing"


class Conflict(KinedexError):
    """The current state does not allow this."""

    code = "conflict"


class ClipNotReady(Conflict):
    """The clip is not ready yet."""

    code = "clip_not_ready"


class ModelNotFitted(Conflict):
    """No model has been fitted on this library yet."""

    code = "model_not_fitted"


class ModelBeingFitted(ModelNotFitted):
    """The model is being fitted: ask again shortly."""


class NotEnoughLabels(Conflict):
    """The library has too few labeled clips to fit this model."""

    code = "not_enough_labels"


class NoSignatures(Conflict):
    """A model of this kind has no signatures."""

    code = "no_signatures"


class NotEnoughKeyposes(Conflict):
    """Too few keyposes were found for this."""

    code = "not_enough_keyposes"


class AlreadyVoted(Conflict):
    """This voter has already voted on this sequence."""

    code = "already_voted"


class CallInProgress(Conflict):
    """A call with this Idempotency-Key is still running; ask again shortly."""

    code = "call_in_progress"


class CallOvertaken(Conflict):
    """This call was given up, so its change was undone."""

    code = "call_overtaken"


class AnswerLost(Conflict):
    """The call with this Idempotency-Key made its change, but its answer was lost."""

    code = "answer_lost"


class LeaseLost(Conflict):
    """The job is over, or was given to another worker."""

    code = "lease_lost"


class WorkerDied(KinedexError):
    """The worker died each time it tried this."""

    code = "worker_died"


class Canceled(KinedexError):
    """This was canceled before it was done."""

    code = "canceled"


class DeadlineExceeded(KinedexError):
    """The call took longer than its limit."""

    code = "deadline_exceeded"


class ClientLeft(KinedexError):
    """The client left before it was answered."""

    code = "client_left"


class StorageError(KinedexError):
    """The store failed."""

    code = "storage"


class DiskFull(StorageError):
    """There is no space left to store this; nothing was stored."""

    code = "disk_full"


class DatabaseGone(StorageError):
    """The database's file was deleted or replaced; put it back, or restart Kinedex."""

    code = "database_gone"


class DatabaseDamaged(StorageError):
    """The database is damaged."""

    code = "database_damaged"


class FileDamaged(StorageError):
    """The stored file is damaged: its bytes have changed since they were stored."""

    code = "file_damaged"


class DatabaseOutOfDate(StorageError):
    """The database is of another version; run `kinedex db upgrade`."""

    code = "database_out_of_date"


class Unauthorized(KinedexError):
    """An API key is needed."""

    code = "unauthorized"


class Forbidden(KinedexError):
    """This API key does not allow that."""

    code = "forbidden"


class LicenseNotAllowed(Forbidden):
    """The policy on licenses does not allow to give this clip out."""

    code = "license_not_allowed"


class ConfigurationError(KinedexError):
    """The settings do not allow this."""

    code = "configuration"


class LibraryMismatch(ConfigurationError):
    """The database and the folder of files do not belong together."""

    code = "library_mismatch"


class ExtraNeeded(KinedexError):
    """This needs an optional part of Kinedex that is not installed."""

    code = "extra_needed"

    @classmethod
    def package(cls, name: str, noun: str) -> Self:
        """The failure for a package that is not installed. noun: what needs it, in the plural."""
        return cls(
            f"{noun} need the package {name}, which is not installed. In a checkout run "
            f"`make install`; otherwise run `pip install {name}` for the Python of Kinedex."
        )
