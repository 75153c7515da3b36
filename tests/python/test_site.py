"""The documentation: its commands are those of the program, and as a site all its links lead somewhere."""

import html.parser
import json
import re
import shlex
import subprocess
import sys
import urllib.parse

import pytest
from conftest import PROGRAM, ROOT, latsch

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")), *(ROOT / place / "README.md" for place in ("examples", "python", "fmu-template"))]


def commands():
    """Commands of the program in the pages, whose usage lines count as well."""
    for page in PAGES:
        blocks = re.findall(r"^```(\w*)\n(.*?)^```", page.read_text(), re.M | re.S)
        for block in (text for language, text in blocks if language in ("", "sh")):
            # a usage line goes on indented
            for line in re.sub(r"\\?\n +", " ", block).splitlines():
                if line.startswith("latsch "):
                    yield page.name, line


def test_commands_in_the_documentation_are_understood():
    found = list(commands())
    assert len(found) > 45, found
    for page, line in found:
        words = shlex.split(re.sub(r"[\[\]]", " ", line), comments=True)[1:]
        # whatever stands before it is looked at first: an option that is not there ends it
        done = latsch(*words, "--help")
        assert done.returncode == 0, f"{page}: {line}\n{done.stderr}"


class Page(html.parser.HTMLParser):
    """Places of a page that links can lead to, and its links."""

    def __init__(self, text):
        super().__init__()
        self.places, self.links = set(), []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.places.update(values[key] for key in ("id", "name") if values.get(key))
        self.links += [values[key] for key in ("href", "src") if values.get(key)]


@pytest.fixture(scope="module")
def site(made_once):
    def make(folder):
        command = [sys.executable, ROOT / "scripts" / "site", "--programs", PROGRAM.parent, "--output", folder / "site"]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr

    output = made_once("site", make) / "site"
    return {page: Page(page.read_text()) for page in output.rglob("*.html")}


def test_links_of_the_site_lead_somewhere(site):
    count = 0
    for page, content in site.items():
        if page.name == "404.html":
            # it is shown wherever the server did not find something, so its links begin at the root
            continue
        for link in content.links:
            parts = urllib.parse.urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (page.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else page
            if target.is_dir():
                target = target / "index.html"
            assert target.exists(), f"{page}: {link}"
            if parts.fragment and target in site:
                assert urllib.parse.unquote(parts.fragment) in site[target].places, f"{page}: {link}"
            count += 1
    assert count > 1000, count


def test_every_model_has_its_page_and_every_command_its_help(site):
    names = {page.stem for page in site if page.parent.name == "models"}
    models = json.loads(latsch("models", "--format", "json").stdout)
    assert {model["name"] for model in models} <= names
    [help_page] = [content for page, content in site.items() if page.name == "commands.html"]
    for command in ("diagnose", "identify", "plan-check"):
        assert f"latsch-{command}" in help_page.places, command
