"""Is every protection tested? Each is taken out of a copy of the package, and the test that watches it must fail."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from experiments.record import ROOT, Row

TESTS = ROOT / "tests"


class Protection(NamedTuple):
    """What protects, and who watches.

    :param promise: what users are promised
    :param file: file of the package that keeps the promise
    :param code: code that does
    :param instead: code without the protection
    :param test: name of the test that fails then
    """

    promise: str
    file: str
    code: str
    instead: str
    test: str

    @property
    def place(self) -> str:
        """Test with its file, as pytest takes it."""
        files = [path for path in TESTS.rglob("test_*.py") if f"def {self.test}(" in path.read_text(encoding="utf-8")]
        (file,) = files
        return f"{file.relative_to(ROOT)}::{self.test}"


PROTECTIONS = (
    Protection(
        "files are replaced as a whole",
        "files.py",
        'path.with_name(f".{uuid.uuid4().hex}.new")',
        "path",
        "test_a_file_keeps_its_content_until_the_new_one_is_complete",
    ),
    Protection(
        "damaged rows of the journal are found",
        "recorded/journal.py",
        "if signature == sign(text) else None",
        "",
        "test_a_damaged_row_costs_its_simulation_only",
    ),
    Protection(
        "a training that does not repeat is refused",
        "recorded/journal.py",
        "if there != request:",
        "if False:",
        "test_a_training_that_does_not_repeat_is_not_resumed",
    ),
    Protection(
        "a training that was extended otherwise is refused",
        "recorded/journal.py",
        'request = {"index": index, "extended_to": budget}',
        'request = {"index": index, "extended_to": self._known.get(index, {}).get("extended_to", budget)}',
        "test_it_cannot_be_extended_to_two_budgets",
    ),
    Protection(
        "the file of somebody's task is not run",
        "runs/recorded_task.py",
        "        task = RecordedTask(",
        "        from sarah.episode.tasks import task_of_text\n\n"
        "        task_of_text(file.name, file.attribute, file.text)\n        task = RecordedTask(",
        "test_nothing_that_opens_a_run_runs_the_file",
    ),
    Protection(
        "another file than the training's is refused",
        "runs/run_folder.py",
        "if self._task.identity != config.task.identity:",
        "if False:",
        "test_another_file_is_refused",
    ),
    Protection(
        "workers refuse the task of a script",
        "episode/workers.py",
        "not is_portable(subject.task):",
        "False:",
        "test_workers_refuse_the_task_of_a_script",
    ),
    Protection(
        "a training whose settings were edited is refused",
        "recorded/journal.py",
        'if different := differences(self._origin, there, f"in this {self._kind.name}"):',
        "if different := '':",
        "test_every_setting_edited_in_turn_is_refused",
    ),
    Protection(
        "a training that was begun with other versions is refused",
        "recorded/folder.py",
        "origin = {**settings, **versions()}",
        "origin = {**settings}",
        "test_other_versions_are_refused",
    ),
    Protection(
        "a journal without its first row is refused",
        "recorded/journal.py",
        "there = _read_signed(first, _hash)",
        "there = _read_signed(first, _hash) or {**self._origin}",
        "test_without_the_first_row_nothing_goes_on",
    ),
    Protection(
        "rows of another training do not count",
        "recorded/journal.py",
        "zlib.crc32(text, self._seed)",
        "zlib.crc32(text)",
        "test_rows_of_another_training_do_not_count",
    ),
    Protection(
        "states of the code are told apart",
        "versions.py",
        'digest.update(b"%d %s %d " % (len(name), name, len(content)) + content)',
        "digest.update(name)",
        "test_the_hash_of_the_sources_tells_states_of_the_code_apart",
    ),
    Protection(
        "outcomes of workers with other code are refused",
        "episode/cluster.py",
        "_check_worker(worker, there, self._packages)",
        "pass",
        "test_a_worker_with_other_code_is_refused_whenever_it_comes",
    ),
    Protection(
        "a resumed training keeps its pictures",
        "training/recorder.py",
        "self._kept = kept_pictures(run)",
        "self._kept = {}",
        "test_a_resumed_training_keeps_its_pictures_and_draws_on",
    ),
    Protection(
        "run folders are locked",
        "files.py",
        "fcntl.flock(file, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))",
        "pass",
        "test_two_trainings_do_not_share_a_run_folder",
    ),
    Protection(
        "weights that are no numbers stop a training",
        "training/learners.py",
        "if not torch.isfinite(torch.stack(norms)).all():",
        "if False:",
        "test_weights_that_are_not_finite_stop_the_training",
    ),
    Protection(
        "Ctrl-C and SIGTERM finish the episode",
        "cli/interruption.py",
        "signal.signal(number, note)",
        "pass",
        "test_killed_locked_stopped_and_resumed",
    ),
    Protection(
        "a full disk is one line",
        "cli/interruption.py",
        "except (SarahError, OSError) as error:",
        "except ZeroDivisionError as error:",
        "test_a_full_disk_stops_the_training_and_space_lets_it_go_on",
    ),
    Protection(
        "states that are no numbers end an episode",
        "simulation/simulator.py",
        "return math.hypot(*position, *orientation, *velocity, *angular_velocity) < LARGEST_STATE",
        "return True",
        "test_a_diverging_simulation_ends_as_diverged_with_a_finite_reward",
    ),
    Protection(
        "results that are no numbers are refused",
        "episode/result.py",
        "if not isinstance(value, str) and not math.isfinite(",
        "if False and not math.isfinite(",
        "test_results_that_are_no_numbers_are_named",
    ),
    Protection(
        "an episode with nothing to show says so",
        "episode/trace.py",
        "if not rows:",
        "if False:",
        "test_who_diverges_while_standing_leaves_nothing_to_show",
    ),
    Protection(
        "readings that are no numbers are passed over",
        "control/baselines.py",
        "reading = self._reading = reading.repaired(self._reading)",
        "self._reading = reading",
        "test_a_sensor_that_drops_out_does_not_stop_the_stepping_by_sensors",
    ),
    Protection(
        "keys that stand twice are refused",
        "formats.py",
        "if key in content:",
        "if False:",
        "test_configuration_files",
    ),
    Protection(
        "robot dimensions are checked",
        "robot/dimensions.py",
        "if name not in known:",
        "if False:",
        "test_bad_dimensions_are_refused_by_name",
    ),
    Protection(
        "options that contradict a resumed run are refused",
        "cli/train.py",
        "if options.out is not None or options.config is not None or options.from_run is not None:",
        "if False:",
        "test_damaged_run_folders",
    ),
    Protection(
        "YAML makes no objects",
        "formats.py",
        "if tag is not None:",
        "if False:",
        "test_configuration_files",
    ),
    Protection(
        "YAML without aliases is all that is read",
        "formats.py",
        "if anchor is not None:",
        "if False:",
        "test_hostile_files_are_refused_within_seconds",
    ),
    Protection(
        "what is no regular file is not read",
        "files.py",
        "if not stat.S_ISREG(os.fstat(descriptor).st_mode):",
        "if False:",
        "test_hostile_files_are_refused_within_seconds",
    ),
    Protection(
        "races at once do not take each other's trainings",
        "reports/race.py",
        "with locked(entry.folder / LOCK_FILE, wait) as is_ours:",
        "for is_ours in (True,):",
        "test_a_killed_race_resumes_and_two_races_at_once_share_the_work",
    ),
    Protection(
        "a race does not mix states of the code",
        "reports/race.py",
        "RunFolder(entry.folder).check_versions()",
        "pass",
        "test_a_race_does_not_mix_states_of_the_code",
    ),
    Protection(
        "no random stream is used twice",
        "training/learners.py",
        "np.random.seed(seeds.exploration)",
        "pass",
        "test_no_random_stream_is_used_twice",
    ),
    Protection(
        "commands do not load models",
        "runs/run_folder.py",
        "task = (config or self.config()).task",
        "task = (config or self.config()).task; import torch; torch.load(self.model_path, weights_only=False)",
        "test_no_file_of_a_run_is_unpickled",
    ),
    Protection(
        "workers are out of others' reach",
        "episode/cluster.py",
        'host="127.0.0.1",',
        'host="0.0.0.0",',
        "test_workers_listen_to_this_machine_only",
    ),
    Protection(
        "the viewer is out of others' reach",
        "cli/view.py",
        'host: str = "127.0.0.1"',
        'host: str = "0.0.0.0"',
        "test_the_page_is_served_to_this_machine_only",
    ),
)


@dataclass(frozen=True)
class Protections:
    """Every protection in turn.

    :param count: number of the protections, from the first
    """

    count: int = len(PROTECTIONS)

    def rows(self) -> Iterator[Row]:
        """A row for each protection.

        :raises SystemExit: if a test does not fail without what it watches
        """
        unwatched = []
        for protection in PROTECTIONS[: self.count]:
            said = verdict(protection)
            if said != "fails":
                unwatched.append(protection.promise)
            yield {"promise": protection.promise, "test": protection.place, "without_it": said}
        if unwatched:
            raise SystemExit(f"nobody watches that {', that '.join(unwatched)}")


def verdict(protection: Protection) -> str:
    """What the test says without the protection.

    :param protection: a protection
    """
    with tempfile.TemporaryDirectory() as folder:
        package = Path(folder) / "sarah"
        shutil.copytree(ROOT / "sarah", package)
        file = package / protection.file
        text = file.read_text(encoding="utf-8")
        if text.count(protection.code) != 1:
            return f"{protection.file} has other code"
        file.write_text(text.replace(protection.code, protection.instead), encoding="utf-8")
        options = ["-q", "-x", "-p", "no:cacheprovider", "-c", str(ROOT / "setup.cfg")]
        command = [sys.executable, "-m", "pytest", *options, str(ROOT / protection.place)]
        environment = {**os.environ, "PYTHONPATH": f"{folder}{os.pathsep}{ROOT}"}
        process = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    return {0: "PASSES", 1: "fails"}.get(process.returncode, "cannot be run")
