"""Instrument errors for flights that `pcor simulate` made without noise.

The noise is white, and that of the laser has a memory of seconds (`ar`). With `1/f` there is additional noise with a 1/f
spectrum over all decades of a flight. An instrument may have a fault ("trouble"): drift, frozen values, bursts, spikes or
gaps. Sizes are realistic: transducer noise as stated by manufacturers (0.01 to 0.05 hPa); laser noise 0.2 m/s for
means over 1 s, mainly differences of the air between beam and pitot tube.
"""

import netCDF4
import numpy

NOISES = ("ar", "1/f")
TROUBLES = ("drift of p", "drift of q", "frozen", "bursts", "spikes and gaps")
RADOME = (("ATTACK", "ADIFR"), ("SSLIP", "BDIFR"))  # computed flow angle, measured differential pressure

# White noise: rms of means over 1 s, in the unit of the variable
WHITE = {
    "PSFD": 0.02, "PSF": 0.02, "QCF": 0.03, "PSFRD": 0.02, "QCFR": 0.03, "QCR": 0.03, "ADIFR": 0.02, "BDIFR": 0.02,
    "PS_A": 0.1, "QC_A": 0.1, "MACH_A": 2e-4, "TASX": 0.2, "TTRR": 0.1, "RTF1": 0.1, "TTHR1": 0.1, "RTH1": 0.1,
    "EDPC": 0.02, "EWX": 0.02, "DPXC": 0.1, "PITCH": 0.02, "ROLL": 0.02, "THDG": 0.04, "GGTRK": 0.02, "GGSPD": 0.03,
    "GGALT": 0.2, "GGVSPD": 0.03, "BNORMA": 0.02, "BLONA": 0.02, "PLWCC": 0.003, "PCAB": 0.3, "ENGTRQ": 0.4,
    "TBAY": 0.05, "RALT": 0.3,
}
# 1/f noise: range of the rms in a decade of frequency, in the unit of the variable
DECADE = {
    "PSFD": (0.005, 0.02), "PSF": (0.005, 0.02), "QCF": (0.005, 0.02), "PSFRD": (0.005, 0.02), "QCFR": (0.005, 0.02),
    "VLAMS": (0.02, 0.06), "TTRR": (0.02, 0.08), "TTHR1": (0.02, 0.08), "EDPC": (0.005, 0.02), "GGALT": (0.1, 0.5),
    "ADIFR": (0.003, 0.01), "BDIFR": (0.003, 0.01), "QCR": (0.005, 0.02), "THDG": (0.01, 0.03),
}


def with_memory(rng, count, memory):
    """Noise with rms 1 and correlation exp(-t/memory), t and memory in s."""
    kept = numpy.exp(-1.0 / memory)
    values = rng.standard_normal(count)
    values[1:] *= numpy.sqrt(1 - kept**2)
    for place in range(1, count):
        values[place] += kept * values[place - 1]
    return values


def one_over_f(rng, count):
    """Noise with a 1/f spectrum above 1 / (4 times the length of the flight), rms 1 in each decade."""
    longer = 1 << (4 * count).bit_length()
    frequency = numpy.fft.rfftfreq(longer)
    amplitude = numpy.zeros(len(frequency))
    amplitude[1:] = 1.0 / numpy.sqrt(frequency[1:])
    phased = amplitude * (rng.standard_normal(len(frequency)) + 1j * rng.standard_normal(len(frequency)))
    series = numpy.fft.irfft(phased, longer)[:count]
    decades = numpy.log10(0.5 * longer)
    expected = numpy.sqrt((amplitude**2).sum()) * 2.0 / longer  # expected rms of the series
    return series / expected * numpy.sqrt(decades)


def laser_noise(rng, noise, roughness, count):
    """Noise of the laser, m/s: the laser (0.05 m/s), and differences of the air, which may increase with `roughness`."""
    own = 0.05 * rng.standard_normal(count)
    size = 0.2 * numpy.clip(roughness / 1e-4, 0.01, 100) ** (rng.choice([0.0, 1 / 6]))
    memory = rng.uniform(1.0, 4.0) if noise == "1/f" else rng.uniform(1.0, 15.0)
    return own + rng.uniform(0.6, 1.5) * size * with_memory(rng, count, memory)


def segments(rng, count, number, min_length, max_length):
    """Random parts of a flight in the air, as slices; lengths in s."""
    for _ in range(number):
        length = int(round(rng.uniform(min_length, max_length)))
        begin = int(rng.integers(300, count - 600 - length))
        yield slice(begin, begin + length)


def trouble(rng, recorded, pair, kinds):
    """Adds the faults `kinds` to the recorded series; returns descriptions."""
    descriptions = []
    count = len(recorded["QCF"])
    for kind, name in (("drift of p", pair[0]), ("drift of q", pair[1])):
        if kind in kinds:
            size, memory = rng.uniform(0.05, 0.15), rng.uniform(600, 900)
            recorded[name] += size * with_memory(rng, count, memory)
            descriptions.append(f"{name} drifts by {size:.2f} hPa, memory {memory:.0f} s")
    if "frozen" in kinds:
        name = str(rng.choice([*pair, "VLAMS", "ADIFR", "TTRR" if "TTRR" in recorded else "TTHR1"]))
        for part in segments(rng, count, int(rng.integers(1, 3)), 30, 240):
            recorded[name][part] = recorded[name][part.start]
            descriptions.append(f"{name} frozen from {part.start} s for {part.stop - part.start} s")
    if "bursts" in kinds:
        name = str(rng.choice([*pair, "VLAMS"]))
        for part in segments(rng, count, int(rng.integers(2, 8)), 1, 20):
            size = rng.choice([-1, 1]) * rng.uniform(0.5, 5.0)
            length = part.stop - part.start
            recorded[name][part] += size + abs(size) * 0.3 * rng.standard_normal(length)
            descriptions.append(f"{name} has a burst of {size:.1f} from {part.start} s for {length} s")
    if "spikes and gaps" in kinds:
        name = str(rng.choice(["VLAMS", "QCF"]))
        hit = rng.random(count) < 0.01
        recorded[name][hit] += {"VLAMS": 3.0, "QCF": 2.0}[name] * rng.standard_normal(hit.sum())
        descriptions.append(f"{name} has 1 % spikes")
        for part in segments(rng, count, 2, 20, 90):
            recorded["VLAMS"][part] = numpy.nan
            descriptions.append(f"VLAMS missing from {part.start} s for {part.stop - part.start} s")
    return descriptions


def record(path, pair, noise, kinds, seed):
    """Adds instrument errors to the noiseless flight in `path`; returns descriptions of faults."""
    rng = numpy.random.default_rng(seed)
    with netCDF4.Dataset(path, "a") as file:
        recorded = {name: numpy.ma.filled(file[name][:].astype(float), numpy.nan)
                    for name in sorted({*WHITE, "VLAMS", "ATTACK", "SSLIP"} & set(file.variables))}
        roughness = numpy.ma.filled(file["TRUE_EDR"][:].astype(float), 1e-4)
        count = len(roughness)
        flow = {angle: recorded[difference] / recorded["QCR"] for angle, difference in RADOME}
        for name, size in WHITE.items():
            if name in recorded:
                recorded[name] += size * rng.standard_normal(count)
        recorded["VLAMS"] += laser_noise(rng, noise, roughness, count)
        if noise == "1/f":
            for name, (lower, upper) in DECADE.items():
                if name in recorded:
                    recorded[name] += rng.uniform(lower, upper) * one_over_f(rng, count)
        for angle, difference in RADOME:
            flown = recorded["QCR"] > 20
            slope = numpy.polyfit(flow[angle][flown], recorded[angle][flown], 1)[0]
            now = recorded[difference] / recorded["QCR"]
            recorded[angle] += numpy.where(flown, slope * (now - flow[angle]), 0.0)
        descriptions = trouble(rng, recorded, pair, kinds)
        for name, values in recorded.items():
            file[name][:] = numpy.ma.masked_invalid(values)
    return descriptions
