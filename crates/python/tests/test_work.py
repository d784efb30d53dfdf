"""Long questions: Python goes on beside them, hears Ctrl-C, and is told how far they are."""

import os
import signal
import subprocess
import sys
import threading
import time

import pytest

import drivemon
from conftest import PEER


def test_other_threads_go_on(recording, motor):
    turns, done = [0], threading.Event()

    def count():
        while not done.wait(0.001):
            turns[0] += 1

    other = threading.Thread(target=count)
    other.start()
    before = turns[0]
    drivemon.compare(recording, motor)
    during = turns[0] - before
    done.set()
    other.join()
    # Were the lock held, the other thread would stand still until the answer is there.
    assert during >= 10


def test_questions_run_beside_each_other(recording, motor):
    expected = drivemon.monitor(recording, motor).json
    answers = []
    ask = lambda: answers.append(drivemon.monitor(recording, motor).json)  # noqa: E731
    threads = [threading.Thread(target=ask) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert answers == [expected] * 4


def test_progress_rises_to_one(recording, motor):
    told = []
    drivemon.compare(recording, motor, progress=lambda what, share: told.append((what, share)))
    assert told[-1][1] == 1.0 and all(isinstance(what, str) for what, _ in told)
    assert [share for _, share in told] == sorted(share for _, share in told)


def test_tqdm_shows_a_bar(motor, capfd):
    drivemon.Recording.from_file(PEER / "none/recording_b.csv.gz", progress=True)
    drivemon.compare(PEER / "none/recording_b.csv.gz", motor, progress=True)
    assert "100%" in capfd.readouterr().err


def test_what_progress_raises_ends_the_question(recording, motor):
    class Enough(Exception):
        pass

    def tell(what, share):
        raise Enough(what)

    with pytest.raises(Enough):
        drivemon.explain(recording, motor, progress=tell)
    assert drivemon.monitor(recording, motor).state == "healthy"
    # All of it takes some five seconds.
    assert work_ends()


def work_ends():
    """Whether the work of a question that nobody waits for ends: this process then takes no processor time any more."""
    for _ in range(120):
        before = time.process_time()
        time.sleep(0.5)
        if time.process_time() - before < 0.05:
            return True
    return False


INTERRUPTED = """
import sys
sys.path.insert(0, {tests!r})
import drivemon
from test_work import work_ends

motor, recording = drivemon.Motor.from_file({motor!r}), drivemon.Recording.from_file({recording!r})
expected = drivemon.monitor(recording, motor).json
begun = False

def tell(what, share):
    global begun
    if not begun:
        begun = True
        print("begun", flush=True)

try:
    drivemon.explain(recording, motor, progress=tell)
    print("answered")
except KeyboardInterrupt:
    assert drivemon.monitor(recording, motor).json == expected
    assert work_ends()
    print("interrupted")
"""


@pytest.mark.skipif(sys.platform == "win32", reason="sends SIGINT")
def test_ctrl_c_is_heard():
    folder = PEER / "magnetizing-saturation"
    script = INTERRUPTED.format(
        tests=os.path.dirname(__file__), motor=str(folder / "motor.toml"), recording=str(folder / "recording.csv.gz")
    )
    asked = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    assert asked.stdout.readline() == "begun\n"
    asked.send_signal(signal.SIGINT)
    rest, _ = asked.communicate()
    assert (rest, asked.returncode) == ("interrupted\n", 0)
