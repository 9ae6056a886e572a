#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A bHaptics Player or a Buttplug server in memory, for tests. It knows nothing of this project: WebSockets are by python3-websockets, messages
as the published protocols have them, and what they do not have is refused. It prints a line for all that happens:

  port PORT            first
  open, gone           a client came, or went
  got TEXT             a message, as it came
  waiting N            when that message's turn has come: how many wait behind it
  motors WHERE LEVELS  what the motors of a position or device do from now on: MOTOR=LEVEL for each that is on
  expired WHERE        the duration of a level ended
  set NAME=VALUE       from now on

Usage: haptic_server.py (bhaptics|buttplug3|buttplug4) [NAME=VALUE ...]
  port=PORT    instead of a free one
  slow=MS      each message takes this long
  silent=1     answers nothing
  speechless=1 carries out messages, and answers none
  deaf=1       reads nothing after the connection is open
  flood=N      sends messages as fast as it can, after N messages
  huge=N       sends 10 MB of JSON after N messages
  drops=N      breaks the connection off, without goodbye, after N messages
  goodbye=N    closes it after N messages
  nothing=1    has no devices
  refuses=N    answers commands to devices with errors, after N messages
  steps=N      of the vibrators, in JSON
  motors=N     vibrators that the device claims to have
  news=MS      sends a status of its devices every MS unasked
  ping=MS      asks for pings
  enforces=1   without a ping for that time: stops all devices and breaks the connection off; prints `unpinged`
  errs=N       answers the command N to devices with an error
  conformance=1  has the devices of Buttplug's own conformance tests (buttplug4)
  gap=MS       between commands
Lines on standard input: `remove` takes the device away, `add` brings it back, NAME=VALUE sets an option from now on, `quit` ends the
server."""

import asyncio
import contextlib
import json
import os
import sys
import traceback

import websockets

KIND = sys.argv[1]
OPTIONS = dict(argument.split("=", 1) for argument in sys.argv[2:])
clients = set()
is_there = "nothing" not in OPTIONS


def number(name, otherwise=0):
    return int(OPTIONS.get(name, otherwise))


def say(*words):
    print(*words, flush=True)


def show(where, levels):
    say("motors", where, " ".join(f"{motor}={level:g}" for motor, level in sorted(levels.items()) if level > 0))


class Refused(Exception):
    """With the text of an error."""


def fields(message, **types):
    """The values of an object that has these fields and no others."""
    if not isinstance(message, dict) or set(message) != set(types):
        raise Refused(f"expected the fields {sorted(types)}, got {message}")
    for name, kind in types.items():
        if not isinstance(message[name], kind) or (kind is int and isinstance(message[name], bool)):
            raise Refused(f"expected {name} to be {kind}")
    return [message[name] for name in types]


# ---- bHaptics Player ----

SIZES = {"VestFront": 20, "VestBack": 20, "ForearmL": 6, "ForearmR": 6, "Head": 6}


class Player:
    def __init__(self):
        self.expiry = {}

    def hello(self):
        return self.status()

    def status(self):
        positions = ["Vest", "ForearmL", "Head"] if is_there else []
        return json.dumps({"RegisteredKeys": [], "ActiveKeys": sorted(self.expiry), "ConnectedDeviceCount": len(positions),
                           "ConnectedPositions": positions, "Status": {}})

    def changed(self):
        return self.status()

    def answer(self, text):
        (submits,) = fields(json.loads(text), Submit=list)
        for submit in submits:
            if submit.get("Type") == "turnOff":
                _, key = fields(submit, Type=str, Key=str)
                self.play(key, {}, 0)
                continue
            _, key, frame = fields(submit, Type=str, Key=str, Frame=dict)
            position, ms, dots = fields(frame, Position=str, DurationMillis=int, DotPoints=list)
            levels = dict(fields(dot, Index=int, Intensity=int) for dot in dots)
            if any(not 0 <= index < SIZES[position] or not 1 <= level <= 100 for index, level in levels.items()) or not 50 <= ms <= 10000:
                raise Refused("out of range")
            if not key.endswith(position):
                raise Refused("the key is of another position")
            self.play(key, levels, ms)
        return self.status()

    def play(self, key, levels, ms):
        where = key.removeprefix("visuotactile-")
        if key in self.expiry:
            self.expiry.pop(key).cancel()
        show(where, levels)
        if levels:
            self.expiry[key] = asyncio.get_running_loop().call_later(ms / 1000, self.expire, key)

    def expire(self, key):
        self.expiry.pop(key)
        say("expired", key.removeprefix("visuotactile-"))


# ---- Buttplug ----


class Buttplug:
    def __init__(self, version):
        self.version = version
        self.levels = {0: {}, 1: {}}
        self.is_known = False
        self.count = 0
        self.commands = 0
        self.pinged = None  # when, or when the server was greeted

    def hello(self):
        return None

    @property
    def vibrators(self):
        return (0, 1) if "conformance" in OPTIONS else range(number("motors")) if "motors" in OPTIONS else (0, 2)

    @property
    def steps(self):
        return 100 if "conformance" in OPTIONS else json.loads(OPTIONS.get("steps", "20"))

    def devices(self):
        if "conformance" in OPTIONS:
            all_of_them = conformance_devices()
            return all_of_them if is_there else {index: device for index, device in all_of_them.items() if index != "0"}
        steps = self.steps
        gap = {"DeviceMessageTimingGap": number("gap")} if "gap" in OPTIONS or self.version == 4 else {}
        if self.version == 3:
            scalar = {"StepCount": steps, "FeatureDescriptor": "", "ActuatorType": "Vibrate"}
            other = {"StepCount": 10, "FeatureDescriptor": "", "ActuatorType": "Rotate"}
            messages = {"ScalarCmd": [scalar] * number("motors") or [scalar, other, scalar], "StopDeviceCmd": {}}
            linear = {"LinearCmd": [{"StepCount": 100, "FeatureDescriptor": "", "ActuatorType": "Linear"}], "StopDeviceCmd": {}}
            all_of_them = [{"DeviceName": "Test Vibrator", "DeviceIndex": 0, "DeviceMessages": messages, **gap},
                           {"DeviceName": "Test Stroker", "DeviceDisplayName": "Mine", "DeviceIndex": 1, "DeviceMessages": linear}]
            return all_of_them if is_there else all_of_them[1:]
        vibrator = {"FeatureDescription": "", "Output": {"Vibrate": {"Value": [0, steps]}}}
        features = {str(index): {"FeatureIndex": index, **vibrator} for index in self.vibrators}
        features.setdefault("1", {"FeatureIndex": 1, "FeatureDescription": "", "Output": {"Rotate": {"Value": [-10, 10]}}})
        stroker = {"0": {"FeatureIndex": 0, "FeatureDescription": "", "Output": {"Position": {"Value": [0, 100]}}}}
        all_of_them = {"0": {"DeviceName": "Test Vibrator", "DeviceIndex": 0, "DeviceFeatures": features, **gap},
                       "1": {"DeviceName": "Test Stroker", "DeviceDisplayName": "Mine", "DeviceIndex": 1, "DeviceFeatures": stroker, **gap}}
        return all_of_them if is_there else {"1": all_of_them["1"]}

    def changed(self):
        if self.version == 4:
            return json.dumps([{"DeviceList": {"Id": 0, "Devices": self.devices()}}])
        if is_there:
            return json.dumps([{"DeviceAdded": {"Id": 0, **self.devices()[0]}}])
        return json.dumps([{"DeviceRemoved": {"Id": 0, "DeviceIndex": 0}}])

    def answer(self, text):
        return json.dumps([self.one(kind, message) for messages in json.loads(text) for kind, message in messages.items()])

    def one(self, kind, message):
        self.count += 1
        message_id = message.get("Id", 0)
        try:
            if not isinstance(message_id, int) or not 0 < message_id < 2**32:
                raise Refused("bad Id")
            return self.reply(kind, message, message_id) or {"Ok": {"Id": message_id}}
        except Refused as error:
            return {"Error": {"Id": message_id, "ErrorMessage": str(error), "ErrorCode": 3}}

    def reply(self, kind, message, message_id):
        is_new = self.version == 4
        if kind == "RequestServerInfo":
            if is_new:
                major, minor, _, _ = fields(message, ProtocolVersionMajor=int, ProtocolVersionMinor=int, ClientName=str, Id=int)
                versions = {"ProtocolVersionMajor": major, "ProtocolVersionMinor": minor}
            else:
                version, _, _ = fields(message, MessageVersion=int, ClientName=str, Id=int)
                versions = {"MessageVersion": version}
            self.is_known = True
            self.pinged = asyncio.get_running_loop().time()
            return {"ServerInfo": {"Id": message_id, "ServerName": "Test Server", "MaxPingTime": number("ping"), **versions}}
        if not self.is_known:
            raise Refused("expected RequestServerInfo")
        if kind == "RequestDeviceList":
            return {"DeviceList": {"Id": message_id, "Devices": self.devices()}}
        if kind == "Ping":
            self.pinged = asyncio.get_running_loop().time()
            return None
        self.commands += 1
        if self.commands == number("errs"):
            raise Refused("no such device")
        if "refuses" in OPTIONS and self.count > number("refuses"):
            raise Refused("the device did not answer")
        if kind == "StopCmd" and is_new:
            device, _, _, _ = fields(message, DeviceIndex=int, Id=int, Inputs=bool, Outputs=bool)
            self.set(device, {})
        elif kind == "StopDeviceCmd" and not is_new:
            device, _ = fields(message, DeviceIndex=int, Id=int)
            self.set(device, {})
        elif kind == "ScalarCmd" and not is_new:
            device, _, scalars = fields(message, DeviceIndex=int, Id=int, Scalars=list)
            for scalar in scalars:
                index, level, actuator = fields(scalar, Index=int, Scalar=(int, float), ActuatorType=str)
                if index not in self.vibrators or actuator != "Vibrate" or not 0 <= level <= 1:
                    raise Refused("no such actuator or level")
                self.set(device, {**self.levels[device], index: level})
        elif kind == "OutputCmd" and is_new:
            device, _, feature, command = fields(message, DeviceIndex=int, Id=int, FeatureIndex=int, Command=dict)
            (output,) = fields(command, Vibrate=dict)
            (level,) = fields(output, Value=int)
            if feature not in self.vibrators or not 0 <= level <= self.steps:
                raise Refused("no such feature or value")
            self.set(device, {**self.levels[device], feature: level})
        else:
            raise Refused(f"unknown message {kind}")
        return None

    def set(self, device, levels):
        if device not in self.levels or (device == 0 and not is_there):
            raise Refused("no such device")
        self.levels[device] = levels
        show(device, levels)


def conformance_devices():
    """As the documentation of buttplug_client_conformance_test has them."""
    def device(index, name, outputs, inputs):
        features = [{"Output": {kind: {"Value": [0, 100], **({"Duration": [0, 1000]} if kind.endswith("Duration") else {})}}} for kind in outputs]
        features += [{"Input": {kind: {"Value": [[0, 100]], "Command": [command]}}} for kind, command in inputs]
        return {"DeviceName": name, "DeviceIndex": index, "DeviceMessageTimingGap": 0,
                "DeviceFeatures": {str(i): {"FeatureIndex": i, "FeatureDescription": "", **feature} for i, feature in enumerate(features)}}
    return {"0": device(0, "Conformance Test Vibrator", ["Vibrate", "Vibrate", "Rotate"], [("Battery", "Read")]),
            "1": device(1, "Conformance Test Positioner", ["Position", "HwPositionWithDuration", "Oscillate"], [("Button", "Subscribe")]),
            "2": device(2, "Conformance Test Multi", ["Constrict", "Spray", "Temperature", "Led"], [("RSSI", "Read"), ("Pressure", "Subscribe")])}


async def enforce_pings(socket, server):
    while server.pinged is None or asyncio.get_running_loop().time() < server.pinged + number("ping") / 1000:
        await asyncio.sleep(0.01)
    say("unpinged")
    server.set(0, {})
    socket.transport.abort()


# ---- both ----


async def flood(socket, server):
    while True:
        await socket.send(server.changed())


async def tell_news(socket, server):
    while True:
        await asyncio.sleep(number("news") / 1000)
        await socket.send(server.changed())


async def listen(socket, messages):
    """Puts what comes in line, and None at the end."""
    with contextlib.suppress(websockets.ConnectionClosed):
        async for text in socket:
            messages.put_nowait(text)
    messages.put_nowait(None)


async def converse(socket, server):
    messages = asyncio.Queue()
    tasks = [listen(socket, messages)]
    if "enforces" in OPTIONS:
        tasks.append(enforce_pings(socket, server))
    if "news" in OPTIONS:
        tasks.append(tell_news(socket, server))
    tasks = [asyncio.create_task(task) for task in tasks]
    count = 0
    try:
        if "deaf" in OPTIONS:
            socket.transport.pause_reading()
        if server.hello() and "silent" not in OPTIONS:
            await socket.send(server.hello())
        while (text := await messages.get()) is not None:
            count += 1
            say("got", text)
            await asyncio.sleep(number("slow") / 1000)
            say("waiting", messages.qsize())
            if "silent" in OPTIONS:
                continue
            answer = server.answer(text)
            if "speechless" in OPTIONS:
                continue
            await socket.send(answer)
            if count == number("huge"):
                await socket.send(json.dumps({"ConnectedPositions": ["x" * 100] * 100_000}))
            if count == number("flood"):
                tasks.append(asyncio.create_task(flood(socket, server)))
            if count == number("drops"):
                socket.transport.abort()
            if count == number("goodbye"):
                await socket.close(1001)
    finally:
        for task in tasks:
            task.cancel()


async def serve(socket, _path=None):  # the path: until python3-websockets 10
    server = Player() if KIND == "bhaptics" else Buttplug(int(KIND[-1]))
    clients.add((socket, server))
    say("open")
    try:
        await converse(socket, server)
    except websockets.ConnectionClosed:
        pass
    except Exception:
        # Else the library would go on without this client, for which a test then waits in vain.
        traceback.print_exc()
        os._exit(1)
    finally:
        clients.discard((socket, server))
        say("gone")


async def main():
    global is_there
    server = await websockets.serve(serve, "127.0.0.1", number("port"), max_queue=None)
    say("port", server.sockets[0].getsockname()[1])
    loop = asyncio.get_running_loop()
    while True:
        line = (await loop.run_in_executor(None, sys.stdin.readline)).strip()
        if line in ("", "quit"):
            break
        if "=" in line:
            OPTIONS.update([line.split("=", 1)])
            say("set", line)
            continue
        is_there = line == "add"
        for socket, one in list(clients):
            with contextlib.suppress(websockets.ConnectionClosed):
                await socket.send(one.changed())
    # At once, without goodbyes.
    for socket, _ in list(clients):
        socket.transport.abort()


asyncio.run(main())
