"""Settings: their sources, their errors, and secrets that they never show."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from app.config import CONFIG_FILE_ENV, load_settings, settings_table
from app.errors import ConfigurationError


@pytest.fixture(autouse=True)
def _clean(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for name in [name for name in os.environ if name.startswith("KINEDEX_")]:
        monkeypatch.delenv(name)
    monkeypatch.chdir(tmp_path)


def test_defaults_are_safe_and_local() -> None:
    settings = load_settings()
    assert (settings.host, settings.port) == ("127.0.0.1", 8000)
    assert settings.listens_on_loopback
    assert settings.database == "sqlite:///data/kinedex.sqlite3"
    assert settings.files_dir == Path("data/files")


def test_flags_win_over_the_environment_and_that_over_the_file(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    Path("kinedex.toml").write_text('port = 1\nhost = "::1"\nmax_frames = 7\n')
    monkeypatch.setenv("KINEDEX_PORT", "2")
    monkeypatch.setenv("KINEDEX_HOST", "0.0.0.0")
    settings = load_settings(port=3, host=None)
    assert (settings.port, settings.host, settings.max_frames) == (3, "0.0.0.0", 7)
    assert not settings.listens_on_loopback


def test_a_named_file_must_exist(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(CONFIG_FILE_ENV, "nowhere.toml")
    with pytest.raises(ConfigurationError, match=r"nowhere\.toml"):
        load_settings()
    Path("nowhere.toml").write_text("port = 9\n")
    assert load_settings().port == 9


@pytest.mark.parametrize("content", ["port = ", "prot = 1\n", 'port = "x"\n'])
def test_a_wrong_file_is_a_configuration_error(content: str) -> None:
    Path("kinedex.toml").write_text(content)
    with pytest.raises(ConfigurationError):
        load_settings()


def test_wrong_values_are_named_but_not_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("KINEDEX_PORT", "hunter2")
    with pytest.raises(ConfigurationError, match="KINEDEX_PORT") as failure:
        load_settings()
    assert [place.location for place in failure.value.places] == ["KINEDEX_PORT"]
    assert "hunter2" not in str(failure.value)


@pytest.mark.parametrize(
    ("name", "suggested"),
    [
        ("KINEDEX_REQUIRE_KEY", "KINEDEX_REQUIRE_KEYS"),
        ("kinedex_require_key", "KINEDEX_REQUIRE_KEYS"),
        ("KINEDEX_DATADIR", "KINEDEX_DATA_DIR"),
        ("KINEDEX_CONFIG", "KINEDEX_CONFIG_FILE"),
        ("KINEDEX_QQQQQQQQQQQQ", None),
        ("KINEDEX_", None),
    ],
)
def test_an_unknown_variable_is_refused(
    monkeypatch: pytest.MonkeyPatch, name: str, suggested: str | None
) -> None:
    monkeypatch.setenv(name, "secret")
    with pytest.raises(ConfigurationError, match=f"{name}: there is no such setting") as caught:
        load_settings()
    (place,) = caught.value.places
    assert place.location == name
    assert (f"did you mean {suggested}?" if suggested else "such setting") in place.message
    assert "secret" not in str(caught.value)


def test_an_unknown_name_in_the_file_is_refused() -> None:
    Path("kinedex.toml").write_text("require_key = true\n")
    with pytest.raises(ConfigurationError, match=r"did you mean KINEDEX_REQUIRE_KEYS\?"):
        load_settings()


def test_other_variables_are_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    Path("mine.toml").write_text("port = 9\n")
    for name in ("KINEDEX_DATA_SET", "KINEDEXX", "MY_KINEDEX_PORT", "kinedex"):
        monkeypatch.setenv(name, "x")
    monkeypatch.setenv("KINEDEX_CONFIG_FILE", "mine.toml")
    monkeypatch.setenv("kinedex_host", "::1")
    assert (load_settings().port, load_settings().host) == (9, "::1")


@pytest.mark.parametrize(("lease", "beat"), [("30", "31"), ("30", "30"), ("4", "5"), ("9", "4.6")])
def test_a_lease_must_allow_two_heartbeats(
    monkeypatch: pytest.MonkeyPatch, lease: str, beat: str
) -> None:
    monkeypatch.setenv("KINEDEX_JOB_LEASE_S", lease)
    monkeypatch.setenv("KINEDEX_JOB_HEARTBEAT_S", beat)
    with pytest.raises(ConfigurationError, match="KINEDEX_JOB_HEARTBEAT_S: must be at most half"):
        load_settings()


def test_a_short_lease_alone_is_refused_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("KINEDEX_JOB_LEASE_S", "4")
    with pytest.raises(ConfigurationError, match="KINEDEX_JOB_HEARTBEAT_S"):
        load_settings()
    monkeypatch.setenv("KINEDEX_JOB_HEARTBEAT_S", "2")
    assert load_settings().job_lease_s == 4


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("KINEDEX_JOB_LEASE_S", "inf"),
        ("KINEDEX_JOB_LEASE_S", "1e300"),
        ("KINEDEX_JOB_POLL_S", "inf"),
        ("KINEDEX_REQUEST_TIMEOUT_S", "inf"),
        ("KINEDEX_JOB_RETENTION_DAYS", "100000000000"),
        ("KINEDEX_QUARANTINE_DAYS", "inf"),
        ("KINEDEX_DATA_DIR", ""),
    ],
)
def test_impossible_times_and_folders_are_refused(
    monkeypatch: pytest.MonkeyPatch, name: str, value: str
) -> None:
    monkeypatch.setenv(name, value)
    with pytest.raises(ConfigurationError, match=name):
        load_settings()


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("KINEDEX_CORS_ORIGINS", "*"),
        ("KINEDEX_CORS_ORIGINS", "https://a.example, b.example"),
        ("KINEDEX_CORS_ORIGINS", "https://a.example/"),
        ("KINEDEX_CORS_ORIGINS", "null"),
        ("KINEDEX_TRUSTED_PROXIES", "*"),
        ("KINEDEX_TRUSTED_PROXIES", "10.0.0.0/8, proxy.example"),
        ("KINEDEX_ROOT_PATH", "kinedex"),
        ("KINEDEX_ROOT_PATH", "/kinedex/"),
        ("KINEDEX_ROOT_PATH", "/"),
    ],
)
def test_what_is_no_origin_no_proxy_and_no_path_is_refused(
    monkeypatch: pytest.MonkeyPatch, name: str, value: str
) -> None:
    monkeypatch.setenv(name, value)
    with pytest.raises(ConfigurationError, match=name):
        load_settings()


def test_lists_are_written_with_commas_or_as_toml(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("KINEDEX_CORS_ORIGINS", "https://A.example ,http://b.example:8080,")
    monkeypatch.setenv("KINEDEX_TRUSTED_PROXIES", "10.0.0.0/8,::1")
    settings = load_settings()
    assert settings.cors_origins == ("https://a.example", "http://b.example:8080")
    assert settings.trusted_proxies == ("10.0.0.0/8", "::1")
    monkeypatch.delenv("KINEDEX_CORS_ORIGINS")
    file = tmp_path / "own.toml"
    file.write_text('cors_origins = ["https://c.example"]\n')
    monkeypatch.setenv(CONFIG_FILE_ENV, str(file))
    assert load_settings().cors_origins == ("https://c.example",)


def test_the_password_of_the_database_is_not_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("KINEDEX_DATABASE_URL", "postgresql://me:hunter2@db/kinedex")
    settings = load_settings()
    assert "hunter2" in settings.database
    assert "hunter2" not in repr(settings) + str(settings) + settings.model_dump_json()


def test_the_table_lists_every_setting_with_its_description() -> None:
    rows = {row.env: row for row in settings_table()}
    assert all(row.description.endswith(".") for row in rows.values())
    assert rows["KINEDEX_PORT"].default == "8000"
    assert rows["KINEDEX_REQUIRE_KEYS"].default == "false"
    assert CONFIG_FILE_ENV in rows


def test_each_default_in_the_table_can_be_set(monkeypatch: pytest.MonkeyPatch) -> None:
    for row in settings_table():
        if row.default and row.env != CONFIG_FILE_ENV:
            monkeypatch.setenv(row.env, row.default)
    assert load_settings().model_dump() == _defaults(monkeypatch)


def _defaults(monkeypatch: pytest.MonkeyPatch) -> dict[str, object]:
    for row in settings_table():
        monkeypatch.delenv(row.env, raising=False)
    return load_settings().model_dump()
