"""Damaged files and wrong inputs: refused with a message, and never another answer."""

from __future__ import annotations

import shutil
from pathlib import Path

from .program import ROOT, Broken, Context, case_arguments, reference, require_decent_end, run

# A damaged case is read and laid out within this time, or something has gone astray.
LONGEST_CHECK = 10.0


def damaged(context: Context, data: bytes) -> bytes:
    """Some bits, bytes, a block, or the length are others."""
    random, changed = context.random, bytearray(data)
    kind = random.choice(["bit", "bytes", "block", "shorter", "longer", "swap"])
    at = random.randrange(len(changed))
    if kind == "bit":
        changed[at] ^= 1 << random.randrange(8)
    elif kind == "bytes":
        for _ in range(random.randint(1, 20)):
            changed[random.randrange(len(changed))] = random.randrange(256)
    elif kind == "block":
        end = min(len(changed), at + 512)
        changed[at:end] = random.choice([bytes(end - at), random.randbytes(end - at)])
    elif kind == "shorter":
        del changed[at:]
    elif kind == "longer":
        changed += random.randbytes(random.randint(1, 4096))
    else:
        other = random.randrange(len(changed))
        first, second = sorted((at, other))
        length = min(256, second - first, len(changed) - second)
        changed[first:first + length], changed[second:second + length] = (
            changed[second:second + length], changed[first:first + length])  # fmt: skip
    return bytes(changed)


def checkpoint_of(context: Context) -> Path:
    """A good checkpoint, made once."""
    path = context.folder / "good.h5"
    if not path.exists():
        folder = context.new_folder()
        ended = run(context, 0, case_arguments("walls", folder, 0.1))
        if ended.code != 0:
            raise Broken(ended.errors)
        sorted(folder.glob("checkpoint-*.h5"))[-1].replace(path)
        shutil.rmtree(folder)
    return path


def checkpoints(context: Context) -> dict[str, int]:
    """A damaged checkpoint is refused."""
    good = checkpoint_of(context).read_bytes()
    bad = damaged(context, good)
    path = context.new_folder() / "bad.h5"
    path.write_bytes(bad)
    ended = run(context, context.random.choice([0, 0, 0, 2]), ["info", str(path)])
    require_decent_end(ended, f"info {path}")
    if bad != good and (ended.code == 0 or str(path) not in ended.errors):
        raise Broken(f"{path} was taken, or its error does not name it: {ended.errors}")
    shutil.rmtree(path.parent)
    return {"damaged checkpoints refused" if ended.code else "undamaged": 1}


def results(context: Context) -> dict[str, int]:
    """Damaged results are mended, or set aside with a warning; the digest stays right."""
    until = 0.15
    expected = reference(context, "walls", until).digest
    folder = context.new_folder()
    arguments = case_arguments("walls", folder, 0.1)
    run(context, 0, arguments)
    name = context.random.choice(["series.csv", "profiles.h5", "particles.vtkhdf", "profiles.h5.metadata",
                                  "particles.vtkhdf.metadata", "case.toml"])  # fmt: skip
    path = folder / name
    path.write_bytes(damaged(context, path.read_bytes()))
    ended = run(context, context.random.choice([0, 2]), [*case_arguments("walls", folder, until), "--resume"])
    require_decent_end(ended, f"{path} damaged")
    if ended.code != 0 or ended.digest != expected:
        raise Broken(f"{path}: code {ended.code}: {ended.errors}")
    aside = any("unreadable" in entry.name for entry in folder.iterdir())
    if aside and "WARN" not in ended.errors:
        raise Broken(f"{path} was set aside without a warning")
    shutil.rmtree(folder)
    return {f"{name} damaged, {'set aside' if aside else 'mended'}": 1}


WORDS = ["0", "-1", "1e300", "nan", "inf", "1e-300", "true", '""', '"x"', "[]", "[1, 2]", "{}", "[[", "]", "=", "\\u0000",
         "9223372036854775807", "1e25", "[stage]", "[[wall]]", "a.b.c = 1"]  # fmt: skip


def changed_case(context: Context, text: str) -> str:
    """Some lines are gone, doubled, or have another value; or some characters are others."""
    random, lines = context.random, text.splitlines()
    for _ in range(random.randint(1, 4)):
        at = random.randrange(len(lines))
        kind = random.choice(["value", "value", "value", "remove", "double", "characters", "insert"])
        if kind == "value" and "=" in lines[at]:
            lines[at] = lines[at].split("=")[0] + "= " + random.choice(WORDS)
        elif kind == "remove":
            lines[at] = ""
        elif kind == "double":
            lines.insert(at, lines[at])
        elif kind == "insert":
            lines.insert(at, random.choice(WORDS))
        elif lines[at]:
            place = random.randrange(len(lines[at]))
            lines[at] = lines[at][:place] + chr(random.choice([random.randrange(128), random.randrange(0x2000)])) + (
                lines[at][place + 1:])  # fmt: skip
    return "\n".join(lines) + "\n"


def inputs(context: Context) -> dict[str, int]:
    """Damaged case files and options: a message that names them, no panic, no endless work."""
    random = context.random
    cases = sorted((ROOT / "cases").glob("*/*.toml")) + sorted((ROOT / "tests" / "cases" / "good").glob("*.toml"))
    source = random.choice(cases)
    folder = context.new_folder()
    path = folder / "case.toml"
    text = source.read_text(encoding="utf-8")
    options: list[str] = []
    if random.random() < 0.7:
        text = changed_case(context, text)
    else:
        keys = [line.split("=")[0].strip() for line in text.splitlines() if "=" in line and not line.startswith("#")]
        sections = ["", "contact.", "gas.", "particles.", "box.", "stage.1.", "time.", "output."]
        options = ["--set", f"{random.choice(sections)}{random.choice(keys)}={random.choice(WORDS)}"]
    path.write_bytes(text.encode("utf-8", errors="replace"))
    # Beds of many particles are legal, and cost what they cost: none is meant here.
    ended = run(context, 0, ["check", str(path), *options, "--set", "run.wall_clock=1s"])
    require_decent_end(ended, f"check {path} {options} (from {source})")
    if ended.code == 1 and str(path) not in ended.errors and "--set" not in ended.errors:
        raise Broken(f"{path} {options}: the error names neither file nor option: {ended.errors}")
    shutil.rmtree(folder)
    return {"inputs taken" if ended.code == 0 else "inputs refused": 1}
