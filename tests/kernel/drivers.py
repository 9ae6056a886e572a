#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs in the virtual machine of run.sh: boards on the kernel's own drivers. Each case is a function. Without names, all are run.

Asserts no times. Waits for events for at most PATIENCE seconds of the machine's clock."""
import contextlib
import grp
import os
import pty
import shutil
import signal
import subprocess
import sys
import time

TESTS, BUILD = os.environ["TESTS"], os.environ["BUILD"]
PATIENCE = 60
ENVIRONMENT = dict(os.environ, HOME="/tmp", XDG_CACHE_HOME="/tmp/cache", XDG_STATE_HOME="/tmp/state", GST_PLUGIN_PATH=BUILD + "/gst",
                   LD_LIBRARY_PATH=BUILD + "/lib/gst/tactile", GST_REGISTRY="/tmp/registry", VISUOTACTILE_GUARDIAN=BUILD + "/tools/tactor-guardian", PATH="/usr/bin:/usr/sbin:/bin:/sbin")


class Failed(Exception):
    pass


def wait_for(what, condition):
    end = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > end:
            raise Failed(f"there was no {what} within {PATIENCE} s")
        time.sleep(0.01)


class Board:
    """A plugged board. Leaving the block unplugs it."""

    def __init__(self, port=0, transport="cdc-acm", pins=range(2, 11), **options):
        self.log = f"/tmp/board-{port}.log"
        if os.path.exists(self.log):
            os.remove(self.log)
        self.pins, self.socket = list(pins), f"1-{port + 1}"
        switches = [f"--{name}" if value is True else f"--{name}={value}" for name, value in options.items()]
        self.process = subprocess.Popen([sys.executable, TESTS + "/usb_board.py", f"--port={port}", f"--transport={transport}", "--log=" + self.log,
                                         "--pins=" + ",".join(map(str, pins)), *switches])
        wait_for("tty", self.tty)

    def tty(self):
        """The port's /dev/tty..., or nothing while no driver is bound."""
        for place, _, _ in os.walk(f"/sys/bus/usb/devices/{self.socket}/"):
            name = os.path.basename(place)
            if name.startswith(("ttyACM", "ttyUSB")) and os.path.exists("/dev/" + name):
                return "/dev/" + name
        return None

    def lines(self):
        with open(self.log) as log:
            return [line.split(None, 1)[1].strip() for line in log]

    def levels(self):
        levels = dict.fromkeys(self.pins, 0)
        for line in self.lines():
            if line.startswith("pwm "):
                _, pin, level = line.split()
                levels[int(pin)] = int(level)
        return levels

    def zeros(self):
        """The times at which motors went off."""
        with open(self.log) as log:
            return [float(line.split(None, 1)[0]) for line in log if line.split()[1:2] == ["pwm"] and line.split()[3] == "0"]

    def on(self):
        return sum(level > 0 for level in self.levels().values())

    def unplug(self):
        self.process.kill()
        self.process.wait()
        wait_for("unplugging", lambda: not os.path.exists(f"/sys/bus/usb/devices/{self.socket}"))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.unplug()


class Play:
    def __init__(self, motors, driver, *device, user=None, groups=None, properties=""):
        self.motors = motors
        self.output = "/tmp/play.log"
        with open(self.output, "w") as output:
            self.process = subprocess.Popen([sys.executable, TESTS + "/play.py", str(motors), driver, *device], stdin=subprocess.PIPE, stdout=output,
                                            stderr=output, text=True, env=dict(ENVIRONMENT, TACTORSINK=properties), user=user, extra_groups=groups)

    def said(self):
        with open(self.output) as output:
            return output.read()

    def wait_to(self, word):
        wait_for(f"'{word}' from the player", lambda: any(line == word for line in self.said().splitlines()) or self.process.poll() is not None)

    def tell(self, word):
        self.process.stdin.write(word + "\n")
        self.process.stdin.flush()

    def end(self):
        if self.process.poll() is None:
            self.tell("")
            self.process.communicate(timeout=PATIENCE)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()


def expect(condition, text):
    if not condition:
        raise Failed(text)


def settled(board):
    """Waits until the kernel's driver has the board, and its line is idle: the log does not change."""
    wait_for("tty after the play", board.tty)
    wait_for("9600 baud from the kernel's driver", lambda: any(line.startswith("baud 96") for line in board.lines()[-4:]))


def stopped(word, motors, leave=None, transport="cdc-acm"):
    with Board(transport=transport) as board, Play(motors, "firmata", "1-1") as play:
        play.wait_to("playing")
        wait_for("motors", lambda: board.on() == motors)
        if leave is None:
            play.tell(word)
            play.wait_to("done")
        else:
            play.process.send_signal(leave)
            play.process.wait(timeout=PATIENCE)
        if word != "pause":
            settled(board)
        else:
            wait_for("zeros", lambda: board.on() == 0)
        left, garbled = board.on(), [line for line in board.lines() if line.startswith("garbled")]
        expect(left == 0, f"{left} of {motors} motors are still on; {', '.join(garbled) or 'nothing garbled'}")
        expect(not garbled, f"bytes were still on the line when it was released: {', '.join(garbled)}")


def stop_4():
    """Four motors, stopped by the application."""
    stopped("null", 4)


def stop_9():
    """Nine motors, stopped by the application."""
    stopped("null", 9)


def stop_9_ch340():
    """Nine motors behind a CH340, stopped by the application."""
    stopped("null", 9, transport="ch340")


def end_9():
    """Nine motors, the stream's end."""
    stopped("eos", 9)


def pause_9():
    """Nine motors, a pause."""
    stopped("pause", 9)


def terminated():
    """SIGTERM while nine motors are on: they stop, and the tty is back."""
    stopped("", 9, signal.SIGTERM)


def hung_up():
    """SIGHUP, as from a closed terminal."""
    stopped("", 9, signal.SIGHUP)


def ended(board, how, since):
    """Waits until all motors are off and the tty is back. Prints the time, which is the machine's."""
    wait_for("zeros", lambda: board.on() == 0)
    zero = max(board.zeros())
    settled(board)
    print(f"     {how}: motors off after {1000 * (zero - since):.0f} ms", flush=True)


def guarded():
    """SIGKILL, SIGSEGV, exec() and _exit(): the guardian stops nine motors, and the tty is back."""
    for how in signal.SIGKILL, signal.SIGSEGV, "exec", "_exit":
        with Board() as board, Play(9, "firmata") as play:
            play.wait_to("playing")
            wait_for("motors", lambda: board.on() == 9)
            begin = time.monotonic()
            if isinstance(how, str):
                play.tell(how)
            else:
                play.process.send_signal(how)
            play.process.wait(timeout=PATIENCE)
            ended(board, how if isinstance(how, str) else how.name, begin)


def two_signals():
    """Each signal twice, and followed by another, without a guardian: nine motors stop, and the tty is back. tests/usb/ways_out.cpp has all pairs."""
    for i, first in enumerate(TWO):
        for second in first, TWO[i - 1]:
            with Board() as board, Play(9, "firmata", properties="guardian=false") as play:
                play.wait_to("playing")
                wait_for("motors", lambda: board.on() == 9)
                begin = time.monotonic()
                play.process.send_signal(first)
                play.process.send_signal(second)
                play.process.wait(timeout=PATIENCE)
                expect(board.on() == 0, f"{first.name}, {second.name}: {board.on()} motors are still on")
                ended(board, f"{first.name}, {second.name}", begin)


def terminal_closed():
    """A terminal is closed in which bash has started a player: SIGHUP by bash, then by the kernel."""
    with Board() as board:
        shell, master = pty.fork()
        if shell == 0:
            os.execve("/bin/bash", ["bash", "--norc", "-i"], dict(ENVIRONMENT, TACTORSINK="guardian=false"))
        os.write(master, f"{sys.executable} {TESTS}/play.py 9 firmata >/tmp/play.log\n".encode())
        wait_for("motors", lambda: board.on() == 9)
        begin = time.monotonic()
        os.close(master)
        os.waitpid(shell, 0)
        ended(board, "a closed terminal", begin)


def timed_out():
    """timeout(1), which sends SIGTERM to the player and to its group, and gst-launch-1.0 -e with Ctrl-C twice."""
    line = ("videotestsrc pattern=solid-color foreground-color=0xff373737 ! video/x-raw,format=GRAY8,width=36,height=1,framerate=30/1 ! capssetter "
            "replace=true join=false caps=application/x-tactile-map,rows=3,columns=3,framerate=30/1 ! tactorsink driver=firmata max-active=0 max-duty=0 "
            "max-on-time=0").split()
    with Board() as board:
        player = subprocess.Popen(["timeout", "1000", "gst-launch-1.0", "-q", *line, "guardian=false"], env=ENVIRONMENT, start_new_session=True)
        wait_for("motors", lambda: board.on() == 9)
        begin = time.monotonic()
        player.terminate()
        player.wait(timeout=PATIENCE)
        ended(board, "timeout", begin)
    with Board() as board:
        player = subprocess.Popen(["gst-launch-1.0", "-q", "-e", *line], env=ENVIRONMENT)
        wait_for("motors", lambda: board.on() == 9)
        begin = time.monotonic()
        player.send_signal(signal.SIGINT)
        time.sleep(0.01)
        player.send_signal(signal.SIGINT)
        player.wait(timeout=PATIENCE)
        ended(board, "gst-launch-1.0 -e, SIGINT twice", begin)


def killed():
    """SIGKILL without a guardian: the tty is missing, and back after the next play."""
    with Board() as board:
        with Play(9, "firmata", properties="guardian=false") as play:
            play.wait_to("playing")
            wait_for("motors", lambda: board.on() == 9)
            play.process.kill()
            play.process.wait(timeout=PATIENCE)
        with Play(1, "firmata") as play:
            play.wait_to("playing")
            wait_for("one motor", lambda: board.on() == 1)
            play.tell("null")
            play.wait_to("done")
            play.end()
        wait_for("tty after the next play", board.tty)
        expect(board.on() == 0, f"{board.on()} motors are still on")


def killed_released():
    """SIGKILL without a guardian, then visuotactile-play --release-boards: motors off, the tty is back."""
    with Board() as board:
        with Play(9, "firmata", properties="guardian=false") as play:
            play.wait_to("playing")
            wait_for("motors", lambda: board.on() == 9)
            play.process.kill()
            play.process.wait(timeout=PATIENCE)
        expect(board.tty() is None, "expected no tty after SIGKILL")
        said = subprocess.run([BUILD + "/tools/visuotactile-play", "--release-boards"], env=ENVIRONMENT, text=True, capture_output=True,
                              timeout=PATIENCE).stdout
        expect("motors stopped" in said, f"it said: {said}")
        wait_for("tty after that", board.tty)
        expect(board.on() == 0, f"{board.on()} motors are still on")


@contextlib.contextmanager
def untouched(board):
    """Fails if anything is sent to the board in this block."""
    before = board.lines()
    yield
    expect(board.lines() == before, f"the adapter was touched: {board.lines()[len(before):]}")


@contextlib.contextmanager
def adapter_in_use():
    """A silent adapter that `cat` keeps reading from."""
    with Board(transport="ftdi", silent=True) as board:
        reader = subprocess.Popen(["cat", board.tty()], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            wait_for("DTR from the reader's open", lambda: "dtr 1" in board.lines())
            with untouched(board):
                yield
            expect(reader.poll() is None, "the reader ended")
            expect(board.tty() is not None, "the kernel's driver lost its port")
        finally:
            reader.kill()
            reader.wait()


def play_simulated():
    with Play(1, "auto") as play:
        play.wait_to("playing")
        expect("simulated" in play.said(), f"expected a simulated chair; it said: {play.said()}")
        play.tell("null")
        play.wait_to("done")


def fail_to_play(why, **options):
    with Play(1, "firmata", "1-1", **options) as play:
        play.wait_to("failed")
        expect(why in play.said(), f"expected '{why}'; it said: {play.said()}")


def in_use_auto():
    """driver=auto does not touch a silent adapter in use by a program."""
    with adapter_in_use():
        play_simulated()


def in_use_named():
    """driver=firmata reports that a program uses the adapter, and does not touch it."""
    with adapter_in_use():
        fail_to_play("in use by another program")


def in_use_unseen():
    """The reader belongs to another user: the kernel's open count tells that the port is in use."""
    with adapter_in_use():
        for place, _, nodes in os.walk("/dev/bus/usb"):
            for node in nodes:
                os.chmod(f"{place}/{node}", 0o666)
        fail_to_play("a program of another user has ttyUSB0 open", user=65534)


def strangers():
    """driver=auto touches no device that was not named, whoever made it."""
    shutil.rmtree(ENVIRONMENT["XDG_STATE_HOME"], ignore_errors=True)
    for transport in "cdc-acm", "ftdi", "ch340":
        with Board(transport=transport, silent=True) as board, untouched(board):
            play_simulated()


def two_of_one_number():
    """Two boards with the same serial number: the named port is used."""
    with Board(0) as first, Board(1) as second:
        before = second.lines()
        with Play(4, "firmata", "1-1") as play:
            play.wait_to("playing")
            wait_for("motors", lambda: first.on() == 4)
            first.unplug()
            wait_for("the loss told", lambda: "tactor-device-lost" in play.said() or "unplugged" in play.said() or "it does not answer" in play.said())
            with Board(0) as again:
                wait_for("motors on the board in the same socket", lambda: again.on() == 4)
                expect(second.lines() == before, f"the other board was touched: {second.lines()[len(before):]}")
                play.tell("null")
                play.wait_to("done")
                settled(again)
                expect(again.on() == 0, f"{again.on()} motors are still on")


@contextlib.contextmanager
def steady_clock():
    """Something always runs in this block. Else the machine's clock leaps to the next timer while all wait for the host's disk: udevd, which has
    to read a file, would be too late by the clock of udevadm."""
    idle = subprocess.Popen(["/bin/sh", "-c", "while :; do :; done"], preexec_fn=lambda: os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0)))
    try:
        yield
    finally:
        idle.kill()
        idle.wait()


def udevadm(*words):
    # The guest's root is a chroot, in which udevadm would do nothing.
    with steady_clock():
        ran = subprocess.run(["udevadm", *words], env=dict(ENVIRONMENT, SYSTEMD_IGNORE_CHROOT="1"), text=True, capture_output=True, check=False)
    expect(ran.returncode == 0, f"udevadm {' '.join(words)}: status {ran.returncode}, {ran.stderr}")
    return ran.stdout


def udev_properties(socket):
    udevadm("settle", f"--timeout={PATIENCE}")
    said = udevadm("info", "--query=property", "/sys/bus/usb/devices/" + socket)
    return dict(line.split("=", 1) for line in said.splitlines())


def permitted():
    """udevd reads the rule: boards and adapters are marked, and nothing else. Their group may play, others may not."""
    rules = "/run/udev/rules.d/"
    os.makedirs(rules, exist_ok=True)
    shutil.copy(TESTS + "/../../data/udev/70-visuotactile.rules", rules)
    with open(rules + "71-visuotactile-group.rules", "w") as file:
        file.write('ENV{VISUOTACTILE_BOARD}=="1", GROUP="plugdev", MODE="0660"\n')
    udevadm("control", "--reload")
    try:
        for transport in "cdc-acm", "ftdi", "ch340":
            with Board(transport=transport) as board:
                found = udev_properties(board.socket)
                expect(found.get("ID_MM_DEVICE_IGNORE") == "1" and ":uaccess:" in found.get("TAGS", ""), f"{transport} is not marked: {found}")
                fail_to_play("may not be opened by you", user=65534, groups=[])
                with Play(4, "firmata", "1-1", user=65534, groups=[grp.getgrnam("plugdev").gr_gid]) as play:
                    play.wait_to("playing")
                    wait_for("motors", lambda: board.on() == 4)
                    play.tell("null")
                    play.wait_to("done")
        found = udev_properties("usb1")
        expect("VISUOTACTILE_BOARD" not in found and ":uaccess:" not in found.get("TAGS", ""), f"the hub is marked: {found}")
    finally:
        shutil.rmtree(rules)
        udevadm("control", "--reload")


TWO = [signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT, signal.SIGALRM, signal.SIGUSR1, signal.SIGABRT]

CASES = [stop_4, stop_9, stop_9_ch340, end_9, pause_9, terminated, hung_up, two_signals, terminal_closed, timed_out, guarded, killed,
         killed_released, in_use_auto, in_use_named, in_use_unseen,
         strangers, two_of_one_number, permitted]


def main():
    names = {case.__name__: case for case in CASES}
    unknown = [name for name in sys.argv[1:] if name not in names]
    if unknown:
        sys.exit(f"FAIL there is no case '{unknown[0]}'; there are {', '.join(names)}")
    failed = 0
    cases = [names[name] for name in sys.argv[1:]] or CASES
    for case in cases:
        print(f"case {case.__name__}", flush=True)
        try:
            case()
            print(f"ok   {case.__name__}: {case.__doc__}", flush=True)
        except (Failed, subprocess.TimeoutExpired) as error:
            failed += 1
            print(f"FAIL {case.__name__}: {case.__doc__}\n     {error}", flush=True)
            for name in filter(os.path.exists, ("/tmp/play.log", "/tmp/board-0.log")):
                with open(name) as log:
                    print(f"[{name}]\n{log.read()[-3000:]}", flush=True)
    print(f"{len(cases) - failed} passed, {failed} failed", flush=True)


main()
