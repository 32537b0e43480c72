"""Dry runs of many targets in one process: a list of them in, {target: output} out, as JSON."""

import json
import sys

from plans import plan

if __name__ == "__main__":
    json.dump({target: plan(target) for target in json.load(sys.stdin)}, sys.stdout)
