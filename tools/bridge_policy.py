#!/usr/bin/env python3
"""A policy that drives a mortise scene: presses a soft fingertip on what is below it with a given force, by touch alone.

    mortise run scenes/robots/finger.yaml --bridge 'tools/bridge_policy.py --force 1' --bridge-every 4

Reads a line of JSON per control step, answers with one (src/bridge/README.md). It keeps nothing from one step to the next but what the state says, so a
run that was stopped goes on as if it had not been.
"""
import argparse
import json
import sys

options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
options.add_argument("--joint", default="knuckle")
options.add_argument("--sensor", default="tip")
options.add_argument("--force", type=float, default=1.0, help="to press with [N]")
options.add_argument("--gain", type=float, default=0.004, help="of the target, per step and newton [rad/N]")
given = options.parse_args()

for line in sys.stdin:
    message = json.loads(line)
    if "hello" in message:
        if given.joint not in message["drives"]:
            sys.exit(f"bridge_policy.py: no drive of '{given.joint}', only of {', '.join(message['drives'])}")
    elif "end" in message:
        break
    else:
        force = -message["sensors"][given.sensor]["force"][2]  # the sensor's z points out of the pad
        target = message["joints"][given.joint]["target"] + given.gain * (given.force - force)
        print(json.dumps({"targets": {given.joint: target}}), flush=True)
