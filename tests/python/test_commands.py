import ast
import functools
import html
import inspect
import json
import os
import re
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest
import xarray as xr
from conftest import run_tool

import pcor

STUB = (Path(pcor.__file__).parent / "_commands.pyi").read_text()

FLIGHTS = ["first.nc", "second.nc"]


def commands():
    """Each command in Python and as the tool takes it."""
    return [
        (lambda: pcor.inspect("first.nc"), ["inspect", "first.nc"]),
        (lambda: pcor.compare(FLIGHTS, model="model.toml", min_airspeed=70, exclude=["turn", "cloud"]),
         ["compare", *FLIGHTS, "-m", "model.toml", "--min-airspeed", "70", "--exclude", "turn", "--exclude", "cloud"]),
        (lambda: pcor.refit(FLIGHTS, model="model.toml", output="f.toml", holdout="third.nc", trust_reference=True),
         ["refit", *FLIGHTS, "-m", "model.toml", "-o", "f.toml", "--holdout", "third.nc", "--trust-reference"]),
        (lambda: pcor.diagnose("first.nc", model="model.toml", try_="k * (ENGTRQ - 50) / 100"),
         ["diagnose", "first.nc", "-m", "model.toml", "--try", "k * (ENGTRQ - 50) / 100"]),
        (lambda: pcor.improve(FLIGHTS, model="model.toml", output="b.toml", trace_variables=True),
         ["improve", *FLIGHTS, "-m", "model.toml", "-o", "b.toml", "--trace-variables"]),
        (lambda: pcor.check("first.nc", model="model.toml"), ["check", "first.nc", "-m", "model.toml"]),
        (lambda: pcor.process("third.nc", model="model.toml", output="c.nc", suffix="_NEW"),
         ["process", "third.nc", "-m", "model.toml", "-o", "c.nc", "--suffix", "_NEW"]),
        (lambda: pcor.simulate("data/scenarios/c130-short.toml", output="s.nc", seed=7),
         ["simulate", "data/scenarios/c130-short.toml", "-o", "s.nc", "--seed", "7"]),
        (lambda: pcor.effects("static-qp"), ["effects", "static-qp"]),
        (lambda: pcor.effects(), ["effects"]),
        (lambda: pcor.add("my-thrust", formula="k * ENGTRQ / 100", model="model.toml", output="m.toml"),
         ["add", "my-thrust", "--formula", "k * ENGTRQ / 100", "-m", "model.toml", "-o", "m.toml"]),
    ]


@functools.cache
def result_of(number):
    return commands()[number][0]()


@pytest.mark.parametrize("number", range(len(commands())), ids=[words[0] for _, words in commands()])
def test_json_equals_that_of_the_tool(in_folder, number):
    result, words = result_of(number), commands()[number][1]
    expected = run_tool(*words, "--json", "-").stdout
    assert result.to_json() == expected
    assert result.to_dict() == json.loads(expected)
    described = re.findall(r"^    ([a-z0-9_]+).*: [a-z]", getattr(pcor, words[0]).__doc__, flags=re.MULTILINE)
    for key, value in json.loads(expected).items():
        assert result[key] == value
        assert key in dir(result) and key in described


def test_text_equals_that_of_the_tool(in_folder):
    words = ["compare", *FLIGHTS, "-m", "model.toml"]
    expected = run_tool(*words).stdout.rstrip("\n")
    result = pcor.compare(FLIGHTS, model="model.toml")
    assert repr(result) == result.text == expected
    assert html.escape(expected) in result._repr_html_()


def test_functions_have_the_options_of_the_tool():
    # The completion lists the same options from another source than the help; options with a value have a separate case.
    script = run_tool("completion", "bash").stdout
    options = dict(re.findall(r"'(\w+) '\*' -'\*\) words='([^']*)'", script))
    with_value = set(re.findall(r"'(\w+) --(\S+) '\*", script))
    offered = [(command, option) for command, words in options.items() for option in re.findall(r"^--(.+)$", words, re.MULTILINE)]
    assert len(options.keys() - {"completion", "man"}) == 11
    for command, option in offered:
        name = {"try": "try_"}.get(option, option.replace("-", "_"))
        if command not in ("completion", "man") and name not in ("help", "version", "json", "json_keys", "quiet"):
            assert name in inspect.signature(getattr(pcor, command)).parameters
            stub = re.search(rf"^def {command}\(.*", STUB, flags=re.MULTILINE)[0]
            assert f", {name}: " in stub and (f", {name}: Optional[bool]" in stub) == ((command, option) not in with_value)


def test_stub_types_match_the_results(in_folder):
    """Reads the classes of the stub, and compares them with the values of a result."""
    classes = {node.name: node for node in ast.parse(STUB).body if isinstance(node, ast.ClassDef)}
    types = {"str": str, "float": (int, float), "bool": bool}
    seen = set()

    def compare(value, annotation):
        kind, _, inner = annotation.partition("[")
        if value is None:
            return
        if kind in types:
            assert isinstance(value, types[kind]), (annotation, value)
            seen.add(kind)
        elif kind == "list":
            for each in value:
                compare(each, inner[:-1])
        elif kind == "Named":
            for each in value.values():
                compare(each, inner[:-1])
        else:
            fields = {line.target.id: ast.unparse(line.annotation) for line in classes[kind].body
                      if isinstance(line, ast.AnnAssign)}
            for name, each in value.items():
                if name not in ("output", "text"):  # attributes of Result
                    compare(each, fields[name])

    for number, (_, words) in enumerate(commands()):
        compare(result_of(number).fields, words[0].capitalize())
    assert seen == {*types}


def test_temperature_calibrates_a_thermometer(in_folder):
    climbs = pcor.simulate("data/scenarios/c130-climbs.toml")
    result = pcor.temperature(climbs.output, model="data/scenarios/models/c130-psfd-eq18.toml")
    assert result.samples > 0 and "a0" in result.coefficients
    assert pcor.Model(result.fitted_model).name


def test_fields_are_attributes_and_items(in_folder):
    result = pcor.compare("first.nc", model="model.toml")
    assert result.models[0].regimes[0].name == result["models"][0]["regimes"][0]["name"]
    with pytest.raises(AttributeError, match="no_such_field"):
        result.no_such_field


def test_models_in_memory_are_accepted(in_folder):
    fit = pcor.refit(FLIGHTS, model=pcor.Model("model.toml").text)
    before, after = (pcor.compare(FLIGHTS, model=model).models[0].rms_hpa for model in ("model.toml", fit))
    assert after < before
    assert fit.fitted_model.parameters["static-qp.a2"] == fit.effects[2].parameters.a2


def test_flights_in_memory_are_accepted(in_folder):
    flight = pcor.open("first.nc")
    from_memory = pcor.compare(flight, model="model.toml", reference="lams").models[0]
    from_file = pcor.compare("first.nc", model="model.toml", reference="lams").models[0]
    # float32 in both files: the very same values
    assert from_memory.rms_hpa == from_file.rms_hpa and from_memory.samples == from_file.samples
    # The values in memory are used: 1 hPa more at the port raises the total pressure by 1 hPa, and the static pressure
    # of the laser by p/(p+q) hPa.
    changed = flight.assign(PSFD=(flight.PSFD + 1.0).assign_attrs(flight.PSFD.attrs))
    moved = pcor.compare(changed, model="model.toml", reference="lams").models[0]
    flying = flight.where(flight.TASX > 60)
    expected = float((flying.PSFD / (flying.PSFD + flying.QCF)).mean()) - 1.0
    assert moved.bias_hpa - from_file.bias_hpa == pytest.approx(expected, abs=0.01)  # delta-p grows with p, by 0.4 %


def test_residuals_have_units_and_times(in_folder):
    result = pcor.compare(FLIGHTS, model="model.toml", reference="lams")
    residuals = result.residuals()
    assert len(residuals) == 2 and residuals[0].RESIDUAL_1.attrs["units"] == "hPa"
    assert residuals[0].Time.dtype.kind == "M" and residuals[0].Time.attrs["standard_name"] == "time"
    used = sum(int((flight.MASK == 0).sum()) for flight in residuals)
    assert used == result.models[0].samples


def test_processed_flight_is_a_dataset(in_folder):
    dataset = pcor.process("third.nc", model="model.toml").dataset
    assert isinstance(dataset, xr.Dataset) and dataset.PSXC.attrs["units"] == "hPa"
    assert dataset.PSXC.attrs["standard_name"] == "air_pressure"


def test_writing_a_report_does_not_change_the_output(in_folder):
    fit = pcor.refit(FLIGHTS, model="model.toml", output="kept.toml")
    time_written = os.stat("kept.toml").st_mtime_ns
    fit.report("refit.html")
    assert "<html" in open("refit.html").read()
    assert os.stat("kept.toml").st_mtime_ns == time_written


def test_several_flights_are_processed_into_a_folder(in_folder):
    for result in pcor.process(FLIGHTS, model="model.toml"), pcor.process(FLIGHTS, model="model.toml", output="made/"):
        assert pcor.open(result.flights[1].output).PSXC.attrs["units"] == "hPa"
        result.report("processed.html")
        with pytest.raises(pcor.Error, match="no single flight"):
            result.dataset


def test_report_of_changed_inputs_is_an_error(in_folder):
    pcor.Model("model.toml").save("changing.toml")
    result = pcor.compare("first.nc", model="changing.toml")
    pcor.Model("model.toml").with_parameters({"static-constant.a0": 0.0}).save("changing.toml")
    with pytest.raises(pcor.Error, match="changed"):
        result.report("changed.html")


def test_tables_are_data_frames(in_folder):
    pandas = pytest.importorskip("pandas")
    result = pcor.compare(FLIGHTS, model="model.toml")
    table = result.to_frame()
    assert isinstance(table, pandas.DataFrame) and {"model", "name", "rms_hpa"} <= set(table)
    assert len(result.to_frame("flights")) == 2 * len(result.models)
    assert len(pcor.refit(FLIGHTS, model="model.toml").to_frame()) == 3
    assert set(pcor.inspect("first.nc").to_frame().role) >= {"static_pressure", "dynamic_pressure"}
    with pytest.raises(pcor.Error, match="no_table"):
        result.to_frame("no_table")


def test_plots_show_the_results(in_folder):
    pytest.importorskip("matplotlib")
    comparison = pcor.compare(FLIGHTS, model="model.toml", reference="lams")
    assert len(comparison.plot().get_yticks()) == len([r for r in comparison.models[0].regimes if r.samples])
    times = [line.get_xdata() for line in comparison.plot("time").get_lines()[:2]]
    assert [len(time) for time in times] == [flight.Time.size for flight in comparison.residuals()]
    lines = comparison.plot("variable", variable="ENGTRQ").get_lines()
    x, y = lines[1].get_data()
    assert y[-1] > y[0] + 0.2  # the flights hide an effect that grows with the torque
    fit = pcor.refit(FLIGHTS, model="model.toml", holdout="third.nc")
    assert len(fit.plot("coefficients").get_yticks()) == 3
    assert "held out" in fit.plot("flights").get_yticklabels()[-1].get_text()
    better = result_of([words[0] for _, words in commands()].index("improve"))
    assert len(better.plot("steps").get_xticks()) == len(better.steps) + 1
    diagnosis = pcor.diagnose(FLIGHTS, model=better)
    bars = diagnosis.plot().patches
    assert bars[0].get_width() == diagnosis.rms_given_hpa and bars[1].get_width() == diagnosis.noise_rms_hpa
    assert "<img" in diagnosis._repr_html_()
    with pytest.raises(pcor.Error, match="regimes"):
        better.plot("regimes")


@pytest.mark.parametrize("call, code", [
    (lambda: pcor.compare("absent.nc", model="model.toml"), "file"),
    (lambda: pcor.compare("first.nc", model="absent-model"), "file"),
    (lambda: pcor.compare("first.nc", model="model.toml", min_airsped=60), "usage"),
    (lambda: pcor.compare("model.toml", model="model.toml"), "file"),
    (lambda: pcor.Model("absent-model"), "file"),
    (lambda: pcor.Model("format = 1\n"), "definition"),
    (lambda: pcor.open("model.toml"), "file"),
    (lambda: pcor.run(["compare"]), "usage"),
])
def test_errors_have_code_and_message(in_folder, call, code):
    with pytest.raises(pcor.Error) as raised:
        call()
    assert raised.value.code == code
    assert raised.value.message and not raised.value.message.startswith("pcor:")


def test_work_reports_progress_and_other_threads_run(in_folder):
    seen, ticks, done = [], [], threading.Event()

    def tick():
        while not done.wait(0.01):
            ticks.append(None)

    ticker = threading.Thread(target=tick)
    ticker.start()
    pcor.refit(FLIGHTS, model="model.toml", progress=lambda *event: seen.append(event))
    done.set()
    ticker.join()
    assert seen and all(0 <= done <= total for _, done, total in seen)
    assert len(ticks) > 10


def test_error_of_a_progress_function_reaches_the_caller(in_folder):
    def fail(task, done, total):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        pcor.refit(FLIGHTS, model="model.toml", progress=fail)


def test_interrupt_stops_the_command(in_folder):
    # A shell starts background jobs, and their children, with SIGINT ignored.
    program = ("import signal\nsignal.signal(signal.SIGINT, signal.default_int_handler)\n"
               "import pcor\ntry:\n pcor.improve(['first.nc', 'second.nc'], model='model.toml', trace_variables=True,"
               "output='stopped.toml', progress=lambda *event: print(flush=True))\n"
               "except KeyboardInterrupt:\n print('stopped')")
    process = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
    process.stdout.readline()  # the work has begun
    process.send_signal(signal.SIGINT)  # as a notebook does, to Python alone
    assert process.communicate(timeout=60)[0].strip() == "stopped"
    assert not list(in_folder.glob("*stopped.toml*"))  # a command that runs to its end writes it
