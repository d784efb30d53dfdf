"""@TITLE@

A dynamic model written by drivemon @VERSION@ from @SOURCE@.
@REMARKS@
Space vectors are amplitude-invariant, in the frame of the stator; all units are SI. Voltages, currents and speed are what the
instruments show, where the motor file has effects on instruments. Nothing but Python's own library is needed:

    import @NAME@

    p, x = @NAME@.Parameters(), @NAME@.START
    for k in range(5000):
        t = k * @NAME@.STEP_S
        u = (...)                                   # as in INPUTS: volts of the phases, load torque, supply frequency
        i_a, i_b, i_c, speed, angle, torque = @NAME@.outputs(t, x, u, p)
        x = @NAME@.step(t, x, u, @NAME@.STEP_S, p)    # a classical Runge-Kutta step, u held

As a program it reads a table of inputs with their time and prints the outputs: python3 @NAME@.py < inputs.csv > outputs.csv
"""

import csv
import math
import sys
from dataclasses import dataclass


@dataclass
class Parameters:
    """Constants of the motor and its effects."""

@PARAMETERS@


STATES = (@STATES@)
START = (0.0,) * len(STATES)
INPUTS = (@INPUTS@)
OUTPUTS = (@OUTPUTS@)
# Step of the simulation from which the model comes, s.
STEP_S = @STEP@
@TABLES@

def derivatives(t, x, u, p@HELD_ARGUMENT@):
    """Rates of change of the states, per second."""
    @STATE_LIST@ = x
    @INPUT_LIST@ = u
@DERIVATIVES@    return (
@RATES@
    )


def outputs(t, x, u, p):
    """What the instruments show, and the torque."""
    @STATE_LIST@ = x
    @INPUT_LIST@ = u
@SHOWN@    return (
@READINGS@
    )

@HELD@
def _advanced(x, h, rate):
    return tuple(a + h * b for a, b in zip(x, rate))


def step(t, x, u, h, p, u_mid=None, u_end=None):
    """The states after a Runge-Kutta step of h seconds; the inputs are held, unless those in the middle and at the end are given."""
    u_mid, u_end = u_mid or u, u_end or u
@BEGIN@    k1 = derivatives(t, x, u, p@HELD_PASSED@)
    k2 = derivatives(t + 0.5 * h, _advanced(x, 0.5 * h, k1), u_mid, p@HELD_PASSED@)
    k3 = derivatives(t + 0.5 * h, _advanced(x, 0.5 * h, k2), u_mid, p@HELD_PASSED@)
    k4 = derivatives(t + h, _advanced(x, h, k3), u_end, p@HELD_PASSED@)
    inner = (a + 2.0 * b + 2.0 * c + d for a, b, c, d in zip(k1, k2, k3, k4))
    return _advanced(x, h / 6.0, inner)


def simulate(rows, p=None, x=START):
    """Yields time and outputs for rows of time and inputs; inputs are held until the next row."""
    p = p or Parameters()
    before = None
    for t, *u in rows:
        if before is not None:
            begin, held = before
            steps = max(1, math.ceil((t - begin) / STEP_S - 1e-9))
            h = (t - begin) / steps
            for k in range(steps):
                x = step(begin + k * h, x, held, h, p)
        yield (t, *outputs(t, x, u, p))
        before = (t, u)


if __name__ == "__main__":
    table = csv.DictReader(sys.stdin)
    rows = ([float(row[name]) for name in ("t", *INPUTS)] for row in table)
    print(",".join(("t", *OUTPUTS)))
    for row in simulate(rows):
        print(",".join(map(repr, row)))
