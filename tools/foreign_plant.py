"""A foreign simulator of machines on their plants, and the recorders that write down what they show.

The plant is the induction machine of motulator (MIT; pip install motulator==0.5.0), a model in stator coordinates with its own parametrization,
integrated here by Runge-Kutta steps of 100 us. Nothing of this project's equations is used. Machines of 0.37 to 45 kW; beliefs wrong by 3 to 8 %.
"""

import cmath
import copy
import gzip
import itertools
import math
from types import SimpleNamespace

STEP_S = 1e-4
NOISE = 0.002
BITS = 12
TURN = 2 * math.pi
# Change of a resistance with the temperature of its winding, 1/K.
COPPER_PER_KELVIN = 0.0039


class Machine:
    """Parameters of a machine, T model per star phase, and its rated values."""

    def __init__(self, rng):
        self.power_w = 370.0 * (45e3 / 370.0) ** rng.random()
        self.pole_pairs = rng.choice([1, 2, 2, 3])
        self.voltage_v, self.frequency_hz = 400.0, 50.0
        size = math.log(self.power_w / 370.0) / math.log(45e3 / 370.0)
        near = lambda small, large, spread: small * (large / small) ** size * math.exp(rng.uniform(-spread, spread))
        efficiency, power_factor = 0.70 + 0.23 * size, 0.70 + 0.16 * size
        apparent = self.power_w / efficiency / power_factor
        self.current_a = apparent / math.sqrt(3) / self.voltage_v
        base = self.voltage_v**2 / apparent
        omega = TURN * self.frequency_hz
        self.r_s = base * near(0.10, 0.016, 0.2)
        self.r_r = base * near(0.075, 0.014, 0.2)
        self.l_s = base * near(0.09, 0.085, 0.25) / omega
        self.l_r = base * near(0.09, 0.085, 0.25) / omega
        self.l_m = base * near(1.5, 3.2, 0.2) / omega
        shaft = omega / self.pole_pairs
        self.slip = self.r_r / base
        self.torque_nm = self.power_w / (shaft * (1 - self.slip))
        self.inertia = 2 * apparent * near(0.12, 0.35, 0.3) / shaft**2
        self.friction = 0.01 * self.torque_nm / shaft


def plate(machine):
    """The machine's plate as TOML: where it gives its rated power at rated voltage, digits as plates have them."""
    omega = TURN * machine.frequency_hz
    phase_v, pairs = machine.voltage_v / math.sqrt(3), machine.pole_pairs

    def at(slip):
        rotor = machine.r_r / slip + 1j * omega * machine.l_r
        main = 1j * omega * machine.l_m
        current = phase_v / (machine.r_s + 1j * omega * machine.l_s + main * rotor / (main + rotor))
        air_gap_w = 3 * abs(current * main / (main + rotor)) ** 2 * machine.r_r / slip
        shaft = omega * (1 - slip) / pairs
        return air_gap_w * pairs / omega * shaft - machine.friction * shaft**2, current, shaft

    low, high = 1e-4, machine.r_r / (omega * (machine.l_s + machine.l_r))
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if at(middle)[0] < machine.power_w else (low, middle)
    power_w, current, shaft = at(low)
    digits = lambda x, n: float(f"{x:.{n}g}")
    return f"""name = "{machine.power_w / 1e3:.2f} kW, {2 * pairs} poles"
power_kw = {digits(power_w / 1e3, 3)}
voltage_volt = {machine.voltage_v:.0f}
frequency_hz = {machine.frequency_hz:.0f}
speed_rpm = {round(60 * shaft / TURN)}
current_amp = {digits(abs(current), 3)}
power_factor = {current.real / abs(current):.2f}
connection = "star"
"""


def at_another_temperature(machine, apart_k, rng):
    """The machine with both windings warmer or colder, the cage not by as much as the stator."""
    kelvin = rng.choice([-1, 1]) * rng.uniform(0.4, 1.0) * apart_k
    other = copy.copy(machine)
    other.r_s *= 1 + COPPER_PER_KELVIN * kelvin
    other.r_r *= 1 + COPPER_PER_KELVIN * kelvin * rng.uniform(0.6, 1.4)
    return other


def interpolated(points):
    """A piecewise linear function of time."""

    def value(t):
        for (t0, y0), (t1, y1) in itertools.pairwise(points):
            if t <= t1:
                return y0 if t1 <= t0 else y0 + (y1 - y0) * max(0.0, t - t0) / (t1 - t0)
        return points[-1][1]

    return value


def steps(rng, begin, end, values, ramp=0.02):
    """Dwells at the values, in equal parts of the time."""
    each = (end - begin) / len(values)
    points = [(0.0, values[0])]
    for k, value in enumerate(values[1:], 1):
        at = begin + each * k + rng.uniform(-0.1, 0.1) * each
        points += [(at, points[-1][1]), (at + ramp, value)]
    return interpolated(points)


class Run:
    """Voltage, frequency and load over time."""

    def __init__(self, machine, supply, rng):
        if supply == "grid":
            self.duration_s = 3.6
            settled = 1.4
            voltages = [1.0, *rng.sample([0.85, 0.9, 0.95, 1.05, 1.1], 3)]
            level = steps(rng, settled - 0.4, self.duration_s, voltages, 0.01)
            amplitude = self.peak(machine)
            self.voltage = lambda t: amplitude * level(t)
            self.frequency = lambda t: machine.frequency_hz
            loads = [0.0, *rng.sample([0.25, 0.5, 0.75, 1.0, 0.1], 4)]
            self.load = self.of(machine, steps(rng, settled, self.duration_s, loads))
        else:
            self.duration_s = 6.0
            levels = [0.3, *rng.sample([0.45, 0.6, 0.75, 0.9, 1.0, 1.15], 4)]
            points = [(0.0, 0.05), (0.9, levels[0])]
            for k, level in enumerate(levels[1:], 1):
                points += [(1.0 * k + 0.3, points[-1][1]), (1.0 * k + 0.75, level)]
            share = interpolated(points)
            amplitude = self.peak(machine)
            self.voltage = lambda t: amplitude * min(1.0, share(t) + 0.03 * (1 - min(1.0, share(t))))
            self.frequency = lambda t: machine.frequency_hz * share(t)
            loads = [0.1, *rng.sample([0.2, 0.4, 0.6, 0.8, 0.9, 0.3], 5)]
            self.load = self.of(machine, steps(rng, 0.6, self.duration_s, loads))

    @staticmethod
    def peak(machine):
        return machine.voltage_v * math.sqrt(2 / 3)

    @staticmethod
    def of(machine, share):
        return lambda t: machine.torque_nm * share(t)


class Sound:
    """A machine in which nothing is wrong, and a plant that does nothing of its own: what a hidden thing or a fault changes of it."""

    def now(self, t):
        """Hears the time, s, before anything is asked of it."""

    def torque(self, t, w, angle, load):
        """N m against positive rotation, beside friction and load."""
        return 0.0

    def drop(self, t, phase, i):
        """V lost in one phase beside its resistance."""
        return 0.0

    def stator(self, t):
        """Factor of the stator resistance."""
        return 1.0

    def rotor(self, t, slip_hz):
        """Factor of the rotor resistance."""
        return 1.0

    def inductance(self, stator, flux):
        """Stator inductance of the gamma model over the flux."""
        return stator

    def leakage(self, leakage, flux):
        """Leakage of the gamma model over its own flux."""
        return leakage

    def voltage_reading(self, t, phase, u):
        return u

    def current_reading(self, t, phase, i):
        return i

    def speed_reading(self, t, w, angle):
        return w


def simulated(machine, hidden, run):
    """Rows of true signals, motulator's machine in Runge-Kutta steps."""
    try:
        from motulator.common.utils import abc2complex, complex2abc
        from motulator.drive.model import InductionMachine
    except ImportError as error:
        raise SystemExit(f"{error}: pip install motulator==0.5.0") from error

    l_s, l_r = machine.l_s + machine.l_m, machine.l_r + machine.l_m
    ratio = l_s / machine.l_m
    r_r, l_ell = ratio**2 * machine.r_r, ratio**2 * l_r - l_s
    par = SimpleNamespace(n_p=machine.pole_pairs, R_s=machine.r_s, R_r=r_r, L_ell=l_ell, L_s=l_s)
    plant = InductionMachine(par)

    def at(t, x):
        hidden.now(t)
        par.R_s = machine.r_s * hidden.stator(t)
        plant.state.psi_ss, plant.state.psi_rs = x[0], x[1]
        par.L_s = hidden.inductance(l_s, abs(x[0]))
        par.L_ell = hidden.leakage(l_ell, abs(x[1] - x[0]))
        load = run.load(t) * math.tanh(x[2].real / 0.5)
        voltage = run.voltage(t) * cmath.exp(1j * x[4].real)
        currents = complex2abc(plant.i_ss)
        return load, voltage, currents

    def rates(t, x):
        load, voltage, currents = at(t, x)
        w, angle = x[2].real, x[3].real
        stator_hz = run.frequency(t)
        par.R_r = r_r * hidden.rotor(t, stator_hz - machine.pole_pairs * w / TURN)
        drops = [hidden.drop(t, k, float(i)) for k, i in enumerate(currents)]
        plant.inp.u_ss = voltage - (abc2complex(drops) if any(drops) else 0)
        plant.inp.w_M = w
        plant.set_outputs(t)
        stator, rotor = plant.rhs()
        brake = load + machine.friction * w + hidden.torque(t, w, angle, load)
        return [stator, rotor, (float(plant.out.tau_M) - brake) / machine.inertia, w, TURN * stator_hz]

    x = [0j, 0j, 0.0, 0.0, 0.0]
    plus = lambda x, k, h: [a + h * b for a, b in zip(x, k)]
    rows = []
    for n in range(round(run.duration_s / STEP_S)):
        t = n * STEP_S
        load, voltage, currents = at(t, x)
        w, angle = x[2].real, x[3].real
        shown = [hidden.voltage_reading(t, k, float(u)) for k, u in enumerate(complex2abc(voltage))]
        shown += [hidden.current_reading(t, k, float(i)) for k, i in enumerate(currents)]
        rows.append([*shown, hidden.speed_reading(t, w, angle), load])
        k1 = rates(t, x)
        k2 = rates(t + STEP_S / 2, plus(x, k1, STEP_S / 2))
        k3 = rates(t + STEP_S / 2, plus(x, k2, STEP_S / 2))
        k4 = rates(t + STEP_S, plus(x, k3, STEP_S))
        x = [a + STEP_S / 6 * (b + 2 * c + 2 * d + e) for a, b, c, d, e in zip(x, k1, k2, k3, k4)]
    return rows


class Instrument:
    """What a recorder on a plant does to true signals: no instrument is exact, and most of what it does is in no data sheet that a user has at hand."""

    # What an explanation may name beside what is hidden in the machine.
    EFFECTS = frozenset(
        ["voltage-gain", "current-gain", "load-gain", "load-delay", "phase-voltage-gain", "phase-current-gain", "current-offset", "voltage-offset"]
        + ["sample-delay", "sensor-filter", "frame-rotation", "speed-scale", "speed-delay"]
    )

    def __init__(self, rng):
        self.every = rng.choice([1, 1, 2, 4])
        self.bits = rng.choice([12, 14, 16])
        self.noise = math.exp(rng.uniform(math.log(0.0003), math.log(0.003)))
        self.range = rng.uniform(1.1, 3.0)
        self.gain = [1 + rng.gauss(0, share) for share in [0.002] * 3 + [0.003] * 3 + [0.0, 0.003]]
        self.zero = [rng.gauss(0, share) for share in [0.001] * 3 + [0.002] * 3 + [0.0, 0.002]]
        self.clamps_lag_s = rng.choice([0.0, rng.uniform(0, 20e-6), rng.uniform(0, 60e-6)])
        self.torque_lag_s = rng.choice([0.0, rng.uniform(0, 5e-3)])
        self.counted_s = rng.choice([0.0, 1e-3, 2e-3, 5e-3, 10e-3])
        self.pulses = rng.choice([1024, 2048, 2500])
        self.noises = [self.noise] * 6 + [0.0 if self.counted_s else self.noise, self.noise]
        self.tachometer_lag_s = 0.0 if self.counted_s else rng.uniform(0, 5e-3)

    def ranged(self, recordings):
        """Chooses its ranges, for all recordings the same."""
        largest = [max(abs(float(row[k])) for rows in recordings for row in rows) for k in range(8)]
        self.full = [max(largest[:3])] * 3 + [max(largest[3:6])] * 3 + largest[6:]

    def read(self, rows):
        """What it shows of the true rows, one for each STEP_S."""
        columns = [list(map(float, column)) for column in zip(*rows)]
        for k in (3, 4, 5):
            columns[k] = lagged(columns[k], self.clamps_lag_s)
        columns[6] = counted(columns[6], self.counted_s, self.pulses) if self.counted_s else lagged(columns[6], self.tachometer_lag_s)
        columns[7] = lagged(columns[7], self.torque_lag_s)
        errors = zip(columns, self.gain, self.zero, self.full)
        shown = [[gain * y + zero * top for y in column] for column, gain, zero, top in errors]
        return list(zip(*shown))[:: self.every]


IDEAL = SimpleNamespace(every=1, bits=BITS, noise=NOISE, noises=[NOISE] * 8, range=1.15, ranged=lambda recordings: None, read=lambda rows: rows)


def lagged(column, time_constant_s):
    """Behind a low pass of first order."""
    if not time_constant_s:
        return column
    keep = math.exp(-STEP_S / time_constant_s)
    return list(itertools.accumulate(column, lambda y, x: keep * y + (1 - keep) * x))


def counted(column, window_s, pulses):
    """The speed as the edges of an encoder that a counter sees in each window, shown until the next one is over."""
    length, edge = round(window_s / STEP_S), TURN / (4 * pulses)
    shown, angle, before, value = [], 0.0, 0, 0.0
    for n, speed in enumerate(column):
        if n % length == 0:
            edges = math.floor(angle / edge)
            value, before = (edges - before) * edge / window_s, edges
        shown.append(value)
        angle += speed * STEP_S
    return shown


def nice(largest):
    """A full scale that an engineer would choose: one of 1, 2, 5 times a power of ten."""
    power = 10 ** math.floor(math.log10(largest))
    return next(f * power for f in (1, 2, 5, 10) if f * power >= largest)


def write(folder, name, supply, rows, rng, instrument, torque=True):
    """A recording and its sidecar, as the recorder writes them, with a torque transducer or without one."""
    rows = instrument.read(rows)
    largest = [instrument.range * max(abs(float(row[k])) for row in rows) for k in range(8)]
    ranges = [nice(max(largest[:3])), nice(max(largest[3:6])), nice(largest[6]), nice(largest[7])]
    scales = [ranges[0]] * 3 + [ranges[1]] * 3 + ranges[2:]
    columns = ("va", "vb", "vc", "ia", "ib", "ic", "speed", *(["torque"] if torque else []))
    lines = [",".join(["t", *columns])]
    for n, row in enumerate(rows):
        codes = []
        for value, full, noise, _ in zip(row, scales, instrument.noises, columns):
            lsb = 2 * full / 2**instrument.bits
            code = round((float(value) + rng.gauss(0, noise * full)) / lsb)
            codes.append(str(max(-(2 ** (instrument.bits - 1)), min(2 ** (instrument.bits - 1) - 1, code))))
        lines.append(f"{n * STEP_S * instrument.every:.4f}," + ",".join(codes))
    with gzip.open(folder / f"{name}.csv.gz", "wt") as file:
        file.write("\n".join(lines) + "\n")
    sidecar = [
        'voltage = "instantaneous"',
        'supply = "grid"' if supply == "grid" else 'supply = "inverter"',
        'load_torque = "measured"' if torque else 'load_torque = "free"',
        'starts_from = "standstill"',
        "",
        "[sensors]",
        f"voltage_full_scale_volt = {ranges[0]:.1f}",
        f"current_full_scale_amp = {ranges[1]:.2f}",
        f"speed_full_scale_rad_s = {ranges[2]:.1f}",
        *([f"torque_full_scale_nm = {ranges[3]:.2f}"] if torque else []),
        f"noise_sigma_fraction_of_full_scale = {instrument.noise:.3g}",
        f"adc_bits = {instrument.bits}",
        "",
    ]
    sidecar += [f"[columns.{c}]\nscale = {2 * full / 2**instrument.bits!r}" for c, full in zip(columns, scales)]
    (folder / f"{name}.toml").write_text("\n".join(sidecar) + "\n")


def write_motor(folder, machine, rng):
    """What the user believes of the machine."""
    off = lambda: 1 + rng.choice([-1, 1]) * rng.uniform(0.03, 0.08)
    leakage = off()
    (folder / "motor.toml").write_text(
        f"""name = "{machine.power_w / 1e3:.2f} kW, {2 * machine.pole_pairs} poles"

[nameplate]
pole_pairs = {machine.pole_pairs}
power_watt = {machine.power_w:.0f}.0
voltage_line_rms_volt = {machine.voltage_v}
current_rms_amp = {machine.current_a:.3f}
frequency_hz = {machine.frequency_hz}
torque_nm = {machine.torque_nm:.3f}
connection = "star"

[parameters]
stator_resistance_ohm = {machine.r_s * off():.6g}
rotor_resistance_ohm = {machine.r_r * off():.6g}
stator_leakage_henry = {machine.l_s * leakage:.6g}
rotor_leakage_henry = {machine.l_r * leakage:.6g}
magnetizing_inductance_henry = {machine.l_m * off():.6g}
inertia_kg_m2 = {machine.inertia * off():.6g}
friction_nm_s = {machine.friction * off():.6g}
load_friction_nm_s = 0.0
"""
    )
