"""The age of results: how many commits since have touched what they depend on."""

from __future__ import annotations

from experiments import record
from experiments.found import Package, find, paths_of


def say_ages(package: Package) -> None:
    """Print, for each result, where it was made and what has changed since.

    :param package: experiments whose results are asked for
    """
    known = [name for name in paths_of(package) if name in record.names()]
    for name in known:
        result = record.read(name)
        print(f"{name:{max(map(len, known))}}  made at {made_at(result)}: {age(result, find(name).full.depends_on)}")


def made_at(result: record.Result) -> str:
    """Commit and day of a result, and whether there were changes that no commit has.

    :param result: the result
    """
    dirty = " with uncommitted changes" if result.tree else ""
    return f"{result.commit.split()[-1]}{dirty} on {result.date}"


def age(result: record.Result, folders: tuple[str, ...]) -> str:
    """What has changed since a result was made, in words.

    :param result: the result
    :param folders: folders that it depends on
    """
    first = result.commit.split()[0]
    if record.commit() == record.UNKNOWN or record.git("rev-parse", "--is-shallow-repository") == "true":
        return "cannot tell without the whole history"
    if record.git("merge-base", "--is-ancestor", first, "HEAD") is None:
        return f"cannot tell, as {first} is no earlier commit of this one"
    count = record.git("rev-list", "--count", f"{first}..HEAD", "--", *folders)
    return f"{count} commits since have touched {', '.join(folders)}"
