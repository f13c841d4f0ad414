"""How strong an effect is on flights: what the fitted model cannot absorb of it, in hPa.

The same flights are simulated without noise, with the effect and without. The difference of their residuals, less what
the coefficients of the user's model can take over, has an rms; held against the noise it is the signal-to-noise ratio.
"""

import netCDF4
import numpy

import plans


def read(path, *names):
    with netCDF4.Dataset(path) as file:
        return [numpy.ma.filled(file[name][:].astype(float), numpy.nan).ravel() for name in names]


def residual_of(tool, flight, model, folder, arguments=()):
    path = folder / "residuals.nc"
    tool.run("compare", flight, "-m", model, "--residuals", path, "--quiet", *arguments)
    (residual,) = read(path, "RESIDUAL_1")
    path.unlink()
    return residual


def columns_of(flight, aircraft, without):
    """Columns of the coefficients of the user's model, hPa."""
    p, q, a, qr, attack = read(flight, plans.STATIC[aircraft], "QCF", "ADIFR", "QCR", "ATTACK")
    with numpy.errstate(all="ignore"):
        mach = numpy.sqrt(5.0 * numpy.expm1(numpy.log1p(q / p) * 2.0 / 7.0))
        columns = {"static-constant": p, "static-alpha": p * a / qr, "static-qp": q, "static-mach3": p * mach**3,
                   "static-attack": p * attack}
    return numpy.array([columns[name] for name in plans.LAWS[aircraft] if name not in without]).T


def left_over(difference, columns):
    """Rms of the part of a difference of residuals that the columns do not explain, and of the whole difference."""
    used = numpy.isfinite(difference) & numpy.isfinite(columns).all(axis=1)
    x, y = columns[used], difference[used]
    scale = numpy.sqrt((x**2).mean(axis=0))
    coefficients = numpy.linalg.lstsq(x / scale, y, rcond=None)[0]
    rest = y - x / scale @ coefficients
    return float(numpy.sqrt((rest**2).mean())), float(numpy.sqrt((y**2).mean()))
