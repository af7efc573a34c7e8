"""Case files, options and files of particles, wrong at random and by grammar: a message that names the place, no panic."""

from __future__ import annotations

import re
import shutil
from functools import cache
from pathlib import Path
from random import Random

from .case_reader import CaseReader
from .damage import damaged
from .program import ROOT, Broken, Context, require_decent_end, run

WORDS = ["0", "-1", "1", "1e300", "nan", "inf", "1e-300", "true", '""', '"x"', "[]", "[1, 2]", "[1.0, 2.0, 3.0]", "{}", "[[",
         "]", "=", "\\u0000", "9223372036854775807", "1e25", "[stage]", "[[wall]]", "a.b.c = 1", '"periodic"', '"wall"',
         '"off"', '"random"', "{ from = 0.0, to = 1e9 }", "0.5", "2", "1e-9"]  # fmt: skip
SECTIONS = ["", "contact.", "gas.", "particles.", "particles.start.", "box.", "stage.1.", "time.", "output.", "cohesion.",
            "checkpoint.", "parallel.", "measure.a.", "wall.1."]  # fmt: skip
# File and line, the option, or a section or another file that is missing.
PLACED = re.compile(r"^(bed: )?\S+?(:\d+(:\d+)?|, --set .*?): |.*(: missing: must be |cannot be opened: )", re.DOTALL)
# An error may have several lines; the next one begins with the file again.
EACH = re.compile(r"\n(?=case\.toml)")


@cache
def sources() -> list[Path]:
    """The cases that are damaged."""
    return sorted((ROOT / "cases").glob("*/*.toml")) + sorted((ROOT / "tests" / "cases" / "good").glob("*.toml"))


@cache
def text_of(path: Path) -> str:
    """The contents of a file."""
    return path.read_text(encoding="utf-8")


@cache
def keys() -> list[str]:
    """All keys of the cases."""
    lines = [line for path in sources() for line in text_of(path).splitlines()]
    return sorted({line.split("=")[0].strip() for line in lines if "=" in line and not line.startswith("#")})


def changed_case(random: Random, text: str) -> str:
    """Removes or doubles some lines, takes them from another case, gives them another value, or changes some characters."""
    lines = text.splitlines()
    for _ in range(random.randint(1, 4)):
        at = random.randrange(len(lines))
        kind = random.choice(["value", "value", "value", "scale", "remove", "double", "characters", "insert", "other"])
        if kind == "value" and "=" in lines[at]:
            lines[at] = lines[at].split("=")[0] + "= " + random.choice(WORDS)
        elif kind == "scale":
            factor = 10.0 ** random.uniform(-3.0, 3.0)
            lines[at] = re.sub(r"\d+\.\d+(e-?\d+)?", lambda found: repr(float(found[0]) * factor), lines[at])
        elif kind == "remove":
            lines[at] = ""
        elif kind == "double":
            lines.insert(at, lines[at])
        elif kind == "insert":
            lines.insert(at, random.choice(WORDS))
        elif kind == "other":
            lines.insert(at, random.choice(text_of(random.choice(sources())).splitlines()))
        elif lines[at]:
            place = random.randrange(len(lines[at]))
            lines[at] = lines[at][:place] + chr(random.choice([random.randrange(128), random.randrange(0x2000)])) + (
                lines[at][place + 1:])  # fmt: skip
    return "\n".join(lines) + "\n"


def random_input(random: Random) -> tuple[Path, str, list[str]]:
    """The origin of a case, its text, and its options; either the text or the options are wrong."""
    source = random.choice(sources())
    if random.random() < 0.7:
        text = changed_case(random, text_of(source)).encode("utf-8", errors="replace").decode("utf-8")
        return source, text, []
    values = [f"{random.choice(SECTIONS)}{random.choice(keys())}={random.choice(WORDS)}" for _ in range(random.randint(1, 2))]
    return source, text_of(source), values


def inputs(context: Context) -> dict[str, int]:
    """Runs the program with wrong cases and options: it prints a message that names them, does not panic, and ends."""
    source, text, values = random_input(context.random)
    options = [word for value in values for word in ("--set", value)]
    folder = context.new_folder()
    for beside in [*source.parent.glob("*.csv"), *source.parent.glob("*.dump")]:
        shutil.copy(beside, folder)
    path = folder / "case.toml"
    path.write_text(text, encoding="utf-8")
    ended = run(context, 0, ["check", str(path), *options])
    require_decent_end(ended, f"check {path} {options} (from {source})")
    places = [str(path), "--set", "step ", "cannot be opened: "]
    if ended.code != 0 and not any(place in ended.errors for place in places):
        raise Broken(f"{path} {options}: the error names neither file nor option: {ended.errors}")
    shutil.rmtree(folder)
    return {"inputs taken" if ended.code == 0 else "inputs refused": 1}


def changed_bed(context: Context, source: Path, text: str) -> str:
    """The folder of a case whose file of particles is wrong, in the place of its own."""
    folder = context.folder / "bed"
    folder.mkdir(exist_ok=True)
    for bed in [*source.parent.glob("*.csv"), *source.parent.glob("*.dump")]:
        good = bed.read_bytes()
        bad = damaged(context.random, good)
        if context.random.random() < 0.5:
            bad = changed_case(context.random, good.decode()).encode("utf-8", errors="replace")
        (folder / bed.name).write_bytes(bad)
    return str(folder)


def cases(context: Context) -> dict[str, int]:
    """Wrong cases, options and files of particles in one process: read, small beds made, three steps done."""
    random = context.random
    reader = CaseReader.of(context)
    source, text, values = random_input(random)
    what = "options" if values else "case files"
    folder = str(source.parent)
    with_bed = [path for path in sources() if 'kind = "file"' in text_of(path)]
    if random.random() < 0.15:
        source, what, values = random.choice(with_bed), "files of particles", []
        text = text_of(source)
        folder = changed_bed(context, source, text)
    outcome, message = reader.ask({"text": text, "folder": folder, "set": values})
    if outcome == "refused" and not all(PLACED.match(error) for error in EACH.split(message)):
        return {f"{what}, refused without a place": 1}
    how = "refused" if outcome == "refused" else {"large": "good, too large to try"}.get(message, "good, tried")
    return {f"{what}, {how}": 1}
