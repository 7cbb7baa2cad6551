"""A kind of recorded work that is neither a training nor a session: the longest of some throws of a die."""

import json
import random
import sys
import time
from dataclasses import asdict, dataclass
from pathlib import Path

from sarah.files import replace_text
from sarah.recorded.folder import Folder
from sarah.recorded.kind import Kind

THROWS = Kind("game", "folder", "game.json", "python throws.py")


@dataclass(frozen=True)
class Game:
    seed: int
    throws: int


def play(path: Path, game: Game, seconds: float = 0.0) -> float:
    """Throw until the best is known; a throw takes some seconds."""
    folder, generator, best = Folder(path, THROWS), random.Random(game.seed), 0.0
    with folder.journal(asdict(game), game.throws) as journal:
        for index in range(game.throws):
            request = {"index": index, "force": generator.random() + 0.5 * best}
            distance = journal.known(request, float)
            if distance is None:
                time.sleep(seconds)
                distance = 0.9 * request["force"]
                journal.add(request, distance)
            best = max(best, distance)
        journal.check_asked()
    replace_text(folder.result_path, json.dumps({"best": best}))
    return best


if __name__ == "__main__":
    where, begun = Path(sys.argv[1]), Game(3, 40)
    Folder(where, THROWS).begin(lambda: replace_text(where / "game.json", json.dumps(asdict(begun))))
    play(where, begun, 0.02)
