"""Make a motion: a person and a task, beside the nearest real clip, with what to expect."""

from __future__ import annotations

import re
from collections.abc import Iterator
from urllib.parse import parse_qs, urlsplit

import pytest
from playwright.sync_api import Browser, Page, expect

from app.demo import demo_clips
from tests.live import Live, serve
from tests.web.accessibility import serious_faults
from tests.web.browser import LOOKS, Scheme, opened
from tests.web.pixels import colors_of

LEFT_OUT = ("bruno", "kick")


@pytest.fixture(scope="module")
def gap(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    """A library in which one person never did one of the tasks."""
    with serve(tmp_path_factory.mktemp("gap") / "data", worker=True) as live:
        clips = demo_clips(("ada", "bruno", "chika"), ("walk", "wave", "kick"), takes=2)
        answers = [live.upload(clip) for clip in clips if (clip.person, clip.task) != LEFT_OUT]
        for answer in answers:
            live.wait_for_job(answer.json()["job"]["id"])
        with live.client() as client:
            job = client.post("/v1/models/fit").json()["job"]
        live.wait_for_job(job["id"])
        yield live


def test_a_motion_that_nobody_recorded_plays_beside_a_real_one(browser: Browser, gap: Live) -> None:
    person, task = LEFT_OUT
    with opened(browser, gap.url) as page:
        page.goto("/make")
        page.get_by_role("region", name="Whose motion").get_by_role("button", name=person).click()
        tasks = page.get_by_role("region", name="Which motion")
        expect(tasks.get_by_role("button", name=task)).to_be_visible()
        assert parse_qs(urlsplit(page.url).query) == {"person": [person]}
        group = page.locator("optgroup[label='Never recorded']")
        expect(group.locator("option")).to_have_text([task])
        page.get_by_label("Task").select_option(task)
        player = page.get_by_role("region", name="Player of the made motion")
        expect(player.locator(".head")).to_have_count(2)
        assert colors_of(player.locator("canvas")) > 100
        quality = page.get_by_role("region", name="What to expect")
        expect(quality).to_contain_text(f'2 persons who did "{task}"')
        page.reload()
        expect(player.locator(".head")).to_have_count(2)
        with page.expect_download() as download:
            page.get_by_role("button", name="BVH").click()
        assert download.value.suggested_filename == f"{person}_{task}.bvh"
        page.get_by_role("button", name="Store it as a clip").click()
        page.get_by_role("link", name="To the stored clip").click()
        expect(page).to_have_url(re.compile(r"/clips/clip_\w+$"))


def test_the_person_of_chosen_clips_moves_too(browser: Browser, gap: Live) -> None:
    person, task = LEFT_OUT
    with opened(browser, gap.url) as page:
        page.goto(f"/?person={person}&task=walk")
        boxes = page.get_by_role("checkbox", name=re.compile("^Choose "))
        expect(boxes).to_have_count(2)
        for box in boxes.all():
            box.click()
        page.get_by_role("link", name="Make a motion of this person").click()
        expect(page.get_by_text("The person of")).to_be_visible()
        page.get_by_label("Task").select_option(task)
        expect(page).to_have_url(re.compile(rf"/make\?clips=clip_\w+%2Cclip_\w+&task={task}"))
        player = page.get_by_role("region", name="Player of the made motion")
        expect(player.locator(".head")).to_have_count(2)
        quality = page.get_by_role("region", name="What to expect")
        expect(quality).to_contain_text("of 1 task that")
        page.reload()
        expect(player.locator(".head")).to_have_count(2)
        page.get_by_role("button", name="Choose a person instead").click()
        expect(page.get_by_label("Person")).to_be_visible()


def test_clips_of_two_persons_are_refused(browser: Browser, gap: Live) -> None:
    with gap.client() as client:
        ids = [
            client.get("/v1/clips", params={"person": name, "limit": 1}).json()["items"][0]["id"]
            for name in ("ada", "chika")
        ]
    with opened(browser, gap.url, expected=("422",)) as page:
        page.goto(f"/make?clips={','.join(ids)}&task=kick")
        expect(page.get_by_role("alert").filter(has_text="of one person")).to_be_visible()


def test_what_cannot_be_made_is_said(browser: Browser, demo_service: Live) -> None:
    with opened(browser, demo_service.url, expected=("404", "409", "422")) as page:
        page.goto("/make?person=nobody&task=kick")
        expect(page.get_by_role("alert").filter(has_text="nobody")).to_be_visible()


@pytest.mark.parametrize(("scheme", "size"), LOOKS)
def test_it_has_no_serious_fault(
    browser: Browser, demo_service: Live, scheme: Scheme, size: tuple[int, int]
) -> None:
    with opened(browser, demo_service.url, size=size, scheme=scheme) as page:
        page.goto("/make?person=ada&task=kick")
        expect(page.get_by_role("region", name="What to expect")).to_be_visible()
        assert serious_faults(page) == []
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_nothing_is_made_before_both_are_chosen(page: Page) -> None:
    page.goto("/make")
    expect(page.get_by_label("Person").get_by_role("option", name="ada")).to_be_attached()
    expect(page.get_by_label("Task")).to_be_disabled()
