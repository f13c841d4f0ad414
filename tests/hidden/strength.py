"""Strength of an effect on flights: rms of the part that the fitted model does not absorb, hPa.

The same flights are simulated without noise, with and without the effect. The difference of the residuals, after projecting
out the columns of the user's coefficients, has an rms. This rms over the noise is the signal-to-noise ratio (SNR).
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
    """Derivatives of delta-p with respect to the coefficients of the user's model."""
    p, q, a, qr, attack = read(flight, plans.STATIC[aircraft], "QCF", "ADIFR", "QCR", "ATTACK")
    with numpy.errstate(all="ignore"):
        mach = numpy.sqrt(5.0 * numpy.expm1(numpy.log1p(q / p) * 2.0 / 7.0))
        columns = {"static-constant": p, "static-alpha": p * a / qr, "static-qp": q, "static-mach3": p * mach**3,
                   "static-attack": p * attack}
    return numpy.array([columns[name] for name in plans.LAWS[aircraft] if name not in without]).T


def unabsorbed(difference, columns):
    """Rms of a difference of residuals after least squares with the columns, and rms of the whole difference."""
    used = numpy.isfinite(difference) & numpy.isfinite(columns).all(axis=1)
    x, y = columns[used], difference[used]
    scale = numpy.sqrt((x**2).mean(axis=0))
    coefficients = numpy.linalg.lstsq(x / scale, y, rcond=None)[0]
    rest = y - x / scale @ coefficients
    return float(numpy.sqrt((rest**2).mean())), float(numpy.sqrt((y**2).mean()))
