#!/usr/bin/env python3
"""Draws the front end: docs/front-end/schematic.svg.

Usage: pip install schemdraw==0.23; python3 docs/front-end/schematic.py
Values are those of parts.csv; a test compares parts.csv with the netlists.
"""

import pathlib

import schemdraw
import schemdraw.elements as elm

schemdraw.use("svg")
schemdraw.svgconfig.text = "text"
OUT = pathlib.Path(__file__).resolve().parent / "schematic.svg"


BOX = (7.8, 12.0)


def box(d, y, text, text_x, barrier_x):
    """The part with the barrier, its two outputs, and the dashed line that separates both sides."""
    left, right = BOX
    d += elm.Rect(corner1=(left, y - 2), corner2=(right, y + 2)).at((0, 0))
    for k, line in enumerate(text):
        d += elm.Label().at((text_x, y + 0.75 - 0.55 * k)).label(line, fontsize=11)
    d += elm.Line().at((barrier_x, y + 2.5)).to((barrier_x, y - 2.7)).linestyle("--").color("#b00000")
    d += elm.Label().at((barrier_x, y - 3.4)).label("barrier", fontsize=11, color="#b00000")


def output(d, y, name, upper):
    """A line out of the box at the height of the amplifier's input."""
    at = y + PIN if upper else y - PIN
    d += elm.Line().right().at((BOX[1], at)).length(1.2)
    d += elm.Label().at((BOX[1] + 0.6, at + 0.3 if upper else at - 0.55)).label(name, fontsize=11)


PIN = 0.625


def stage(d, x, y):
    """Difference stage and pin filter behind (x, y +- PIN)."""
    amp = elm.Opamp().right().anchor("in1").at((x + 4.2, y + PIN))
    d += amp
    for pin, upper in ((amp.in1, True), (amp.in2, False)):
        r = elm.Resistor().right().at((x, pin[1])).length(2.6)
        d += r
        d += elm.Line().at(r.end).to(pin)
        d += elm.Label().at((x + 1.3, pin[1] + 0.45 if upper else pin[1] - 0.95)).label("12.1k", fontsize=11)
    node_n, node_p = (x + 3.2, amp.in1[1]), (x + 3.2, amp.in2[1])
    out = amp.out
    # Feedback: resistor and capacitor in parallel above the amplifier.
    d += elm.Dot().at(node_n)
    d += elm.Line().at(node_n).to((x + 3.2, y + 3.4))
    d += elm.Resistor().right().at((x + 3.2, y + 2.1)).to((out[0] + 0.6, y + 2.1)).label("9.53k")
    d += elm.Capacitor().right().at((x + 3.2, y + 3.4)).to((out[0] + 0.6, y + 3.4)).label("8.2n C0G 1 %")
    d += elm.Line().at((out[0] + 0.6, y + 3.4)).to((out[0] + 0.6, out[1]))
    d += elm.Dot().at((x + 3.2, y + 2.1))
    d += elm.Dot().at((out[0] + 0.6, y + 2.1))
    d += elm.Dot().at((out[0] + 0.6, out[1]))
    # The same two from the other input to 1.65 V.
    d += elm.Dot().at(node_p)
    d += elm.Line().at(node_p).down().length(1.3)
    low = (x + 3.2, node_p[1] - 1.3)
    d += elm.Resistor().down().at(low).length(2.0).label("9.53k", loc="top")
    d += elm.Line().right().at(low).length(1.5)
    d += elm.Dot().at(low)
    d += elm.Capacitor().down().at((low[0] + 1.5, low[1])).length(2.0).label("8.2n", loc="bottom")
    d += elm.Line().at((low[0], low[1] - 2.0)).to((low[0] + 1.5, low[1] - 2.0))
    d += elm.Dot(open=True).at((low[0], low[1] - 2.0))
    d += elm.Label().at((low[0] + 0.8, low[1] - 2.7)).label("1.65 V, buffered", fontsize=11)
    # Pin.
    d += elm.Line().at(out).to((out[0] + 0.6, out[1]))
    r = elm.Resistor().right().at((out[0] + 0.6, out[1])).length(2.6).label("150")
    d += r
    d += elm.Dot().at(r.end)
    d += elm.Capacitor().down().at(r.end).length(2.0).label("47n C0G", loc="bottom")
    d += elm.Ground()
    d += elm.Line().right().at(r.end).length(1.8)
    d += elm.Dot(open=True).label("converter pin", loc="right")


def voltage(d, y):
    """Phase to star through the barrier."""
    d += elm.Label().at((-0.6, y + 4.3)).label("Voltage, one of three: 630.8 V full scale", halign="left", fontsize=14)
    d += elm.Dot(open=True).at((0, y + 1.4)).label("phase", loc="left")
    d += elm.Resistor().right().at((0, y + 1.4)).length(3.4).label("4 x 499k in series")
    d += elm.Dot()
    d += elm.Resistor().down().at((3.4, y + 1.4)).to((3.4, y - 1.4)).label("3.32k", loc="top")
    d += elm.Line().right().at((3.4, y + 1.4)).length(2.0)
    d += elm.Dot()
    d += elm.Capacitor().down().at((5.4, y + 1.4)).to((5.4, y - 1.4)).label("1n C0G", loc="bottom")
    d += elm.Line().right().at((5.4, y + 1.4)).to((BOX[0], y + 1.4))
    d += elm.Dot(open=True).at((0, y - 1.4)).label("star", loc="left")
    d += elm.Line().at((0, y - 1.4)).to((BOX[0], y - 1.4))
    d += elm.Dot().at((3.4, y - 1.4))
    d += elm.Dot().at((5.4, y - 1.4))
    box(d, y, ("isolated", "amplifier,", "gain 2, own", "isolated supply"), 9.5, 11.4)
    output(d, y, "out-", True)
    output(d, y, "out+", False)
    stage(d, 13.2, y)


def current(d, y):
    """Transducer with a buffered reference."""
    d += elm.Label().at((-0.6, y + 4.3)).label("Current, one of three: 83.8 A full scale (25 A type)", halign="left", fontsize=14)
    d += elm.Dot(open=True).at((4.6, y + 1.4)).label("from supply", loc="left")
    d += elm.Line().at((4.6, y + 1.4)).to((BOX[0], y + 1.4))
    d += elm.Dot(open=True).at((4.6, y - 1.4)).label("into motor", loc="left")
    d += elm.Line().at((4.6, y - 1.4)).to((BOX[0], y - 1.4))
    box(d, y, ("closed-loop", "fluxgate", "transducer,", "5 V supply"), 10.3, 8.5)
    output(d, y, "ref", True)
    output(d, y, "out", False)
    d += elm.Dot().at((13.2, y + PIN))
    d += elm.Line().at((13.2, y + PIN)).to((13.2, y + 2.6))
    d += elm.Dot(open=True).at((13.2, y + 2.6)).label("2.5 V, buffered", loc="top")
    stage(d, 13.2, y)


with schemdraw.Drawing(file=str(OUT), show=False) as drawing:
    drawing.config(fontsize=11, bgcolor="white", inches_per_unit=0.36, lw=1.4, margin=0.6)
    # Text is wider than the drawing library takes it for: points without anything to see make room.
    for corner in ((-2.0, 5.2), (27.0, -16.0)):
        drawing += elm.Dot(radius=0.01).color("white").at(corner)
    voltage(drawing, 0)
    current(drawing, -11)
