import threading

import numpy as np
import pytest

import pcor

SAMPLES = 1000


def recorded(samples=SAMPLES):
    random = np.random.default_rng(20141014)
    dynamic = random.uniform(30.0, 90.0, samples)
    return {"static_pressure": random.uniform(500.0, 1000.0, samples), "dynamic_pressure": dynamic,
            "recovery_temperature": random.uniform(250.0, 300.0, samples),
            "vapor_pressure": random.uniform(0.1, 2.0, samples),
            "radome_dynamic_pressure": dynamic * random.uniform(0.9, 1.1, samples),
            "attack_differential_pressure": dynamic * random.uniform(-0.3, 0.0, samples)}


def law(arrays):
    """Equation 18 with the coefficients of the model file."""
    a = pcor.Model("c130-psfd-eq18").parameters
    p, q = arrays["static_pressure"], arrays["dynamic_pressure"]
    ratio = arrays["attack_differential_pressure"] / arrays["radome_dynamic_pressure"]
    return p * (a["static-constant.a0"] + a["static-alpha.a1"] * ratio + a["static-qp.a2"] * q / p)


def test_delta_p_agrees_with_equation_18():
    arrays = recorded()
    delta_p = pcor.model("c130-psfd-eq18").delta_p(**arrays)
    np.testing.assert_allclose(delta_p, law(arrays), rtol=1e-12)  # rounding of a sum of three terms


def test_total_pressure_is_kept():
    arrays = recorded()
    result = pcor.Model("c130-psfd-eq18").correct(**arrays)
    total = arrays["static_pressure"] + arrays["dynamic_pressure"]
    np.testing.assert_allclose(result["corrected_static_pressure"] + result["corrected_dynamic_pressure"], total,
                               rtol=1e-14)  # of 1000 hPa: the last bit
    assert set(result) == {"static_defect", "corrected_static_pressure", "corrected_dynamic_pressure",
                           "corrected_mach", "ambient_temperature", "corrected_airspeed"}


def test_shapes_and_other_number_types_are_kept():
    arrays = recorded()
    model = pcor.Model("c130-psfd-eq18")
    flat = model.delta_p(**arrays)
    for shape in (SAMPLES // 25, 25), (SAMPLES, 1):
        np.testing.assert_array_equal(model.delta_p(**{k: v.reshape(shape) for k, v in arrays.items()}),
                                      flat.reshape(shape))
    strided = {name: np.repeat(array, 2)[::2] for name, array in arrays.items()}
    np.testing.assert_array_equal(model.delta_p(**strided), flat)
    single = {name: array.astype(np.float32) for name, array in arrays.items()}
    np.testing.assert_allclose(model.delta_p(**single), flat, atol=1e-5)  # hPa: 6e-8 of 100 hPa, twice
    assert model.delta_p(**{name: array[0] for name, array in arrays.items()}) == flat[0]
    assert model.delta_p(**{name: array[:0] for name, array in arrays.items()}).shape == (0,)


def test_results_are_written_into_given_arrays():
    arrays, model = recorded(), pcor.Model("c130-psfd-eq18")
    out = {"static_defect": np.empty(SAMPLES)}
    result = model.correct(**arrays, outputs=["static_defect"], out=out)
    assert np.shares_memory(result["static_defect"], out["static_defect"])
    np.testing.assert_array_equal(out["static_defect"], model.delta_p(**arrays))
    for wrong in np.empty(SAMPLES - 1), np.empty(SAMPLES, np.float32), np.empty(2 * SAMPLES)[::2], arrays["static_pressure"]:
        with pytest.raises(pcor.Error, match="static_defect"):
            model.correct(**arrays, out={"static_defect": wrong})


def test_missing_values_stay_missing():
    arrays = recorded()
    arrays["static_pressure"][3] = np.nan
    delta_p = pcor.Model("c130-psfd-eq18").delta_p(**arrays)
    assert np.isnan(delta_p[3]) and np.isfinite(np.delete(delta_p, 3)).all()


@pytest.mark.parametrize("change, message", [
    ({"dynamic_pressure": None}, "dynamic_pressure"),
    ({"static_pressure": np.ones(3)}, "shape"),
    ({"static_presure": np.ones(SAMPLES)}, "static_presure"),
])
def test_invalid_arrays_are_errors(change, message):
    arrays = {name: array for name, array in {**recorded(), **change}.items() if array is not None}
    with pytest.raises(pcor.Error, match=message):
        pcor.Model("c130-psfd-eq18").correct(**arrays)


def test_unknown_results_are_errors():
    for outputs in ["no_such_result"], ["lams_static_defect"]:
        with pytest.raises(pcor.Error, match=outputs[0]):
            pcor.Model("c130-psfd-eq18").correct(**recorded(), outputs=outputs)


def test_variables_of_a_formula_are_given_by_name():
    text = pcor.Model("c130-psfd-eq18").text + """
[[effect]]
id = "my-thrust"
where = "static"
formula = "k * (ENGTRQ - 50) / 100"
parameters = { k = 0.8 }
unit = "hPa"
"""
    torque = np.linspace(0.0, 100.0, SAMPLES)
    own = pcor.Model(text).delta_p(**recorded(), ENGTRQ=torque)
    np.testing.assert_allclose(own - law(recorded()), 0.8 * (torque - 50.0) / 100.0, atol=1e-12)  # of 5 hPa
    with pytest.raises(pcor.Error, match="ENGTRQ"):
        pcor.Model(text).delta_p(**recorded())


def test_parameters_are_changed_in_a_copy():
    model = pcor.Model("c130-psfd-eq18")
    changed = model.with_parameters({"static-constant.a0": 0.0})
    assert changed.parameters["static-constant.a0"] == 0.0 != model.parameters["static-constant.a0"]
    assert pcor.Model(changed.text).parameters == changed.parameters
    with pytest.raises(pcor.Error, match="static-constant.a9"):
        model.with_parameters({"static-constant.a9": 0.0})


def test_corrected_flight_equals_that_of_the_tool(in_folder):
    flight = pcor.open("first.nc")
    result = pcor.Model("model.toml").correct(flight)
    processed = pcor.process("first.nc", model="model.toml", correct_with="model").dataset
    flying = (flight.TASX > 60).values
    for name, variable, offset in [("static_defect", "PCOR", 0), ("corrected_static_pressure", "PSXC", 0),
                                   ("corrected_airspeed", "TASX", 0), ("ambient_temperature", "ATX", 273.15)]:
        # float32 in the file: 1000 hPa and 300 K to 6e-5
        np.testing.assert_allclose(result[name].values[flying], processed[variable].values[flying] + offset, atol=1e-4)
    assert result.corrected_static_pressure.attrs == {"units": "hPa", "long_name": "corrected static pressure, p",
                                                      "standard_name": "air_pressure"}
    assert result.corrected_static_pressure.dims == flight.PSFD.dims


def test_units_and_roles_of_a_flight_are_used(in_folder):
    flight = pcor.open("first.nc")
    model = pcor.Model("model.toml")
    pascals = flight.assign(PSFD=(flight.PSFD.astype(float) * 100).assign_attrs(units="Pa")).rename(PSFD="P")
    np.testing.assert_allclose(model.delta_p(pascals, roles={"static_pressure": "P"}), model.delta_p(flight),
                               rtol=1e-12, equal_nan=True)
    with pytest.raises(pcor.Error, match="PSFD"):
        model.delta_p(pascals)
    with pytest.raises(pcor.Error, match="unit") as raised:
        model.delta_p(flight.assign(PSFD=flight.PSFD.assign_attrs(units="furlong")))
    assert raised.value.code == "unit"


def test_loop_equals_arrays():
    model, arrays = pcor.Model("c130-psfd-eq18"), recorded(50)
    whole = model.correct(**arrays)
    loop = pcor.Loop(model, rate=1.0)
    assert loop.delay == 0
    for i in range(50):
        result = loop.run(float(i), **{name: array[i] for name, array in arrays.items()})
        for name in whole:
            assert result[name] == pytest.approx(whole[name][i], rel=1e-13)  # what Batch states
    result = loop.run(50.0, static_pressure=700.0)
    assert np.isnan(result["static_defect"]) and "dynamic_pressure_missing" in loop.flags(result["quality"])
    with pytest.raises(pcor.Error, match="cabin_pressure"):
        loop.run(51.0, cabin_pressure=800.0)


def test_correct_releases_the_gil_and_keeps_its_inputs():
    model, arrays = pcor.Model("c130-psfd-eq18"), recorded(2_000_000)
    frozen = {name: array.copy() for name, array in arrays.items()}
    ticks, done = [], threading.Event()

    def tick():
        while not done.wait(0.001):
            ticks.append(None)

    ticker = threading.Thread(target=tick)
    ticker.start()
    model.correct(**arrays)
    done.set()
    ticker.join()
    assert len(ticks) > 3
    for name in arrays:
        np.testing.assert_array_equal(arrays[name], frozen[name])


def test_old_times_of_nimbus_are_decoded(tmp_path):
    xarray = pytest.importorskip("xarray")
    old = xarray.Dataset({"base_time": ((), 1077114120, {"units": "seconds since 1970-01-01 00:00:00 +0000"}),
                          "time_offset": ("Time", [0.0, 1.0], {"units": "seconds since 2004-02-18 14:22:00 +0000"}),
                          "PSFD": ("Time", [1000.0, 999.0], {"units": "mbar"})})
    old.to_netcdf(tmp_path / "old.nc")
    flight = pcor.open(tmp_path / "old.nc")
    assert flight.Time.values[1] == np.datetime64("2004-02-18T14:22:01")
