"""The model of a package is found from its script and its modules, installed or not."""

import pytest
from eddi_runtime.places import NoModelFileError, find_model

PLACES = {
    "script in the source tree": ("scripts/RosNode.py", "config"),
    "module in the source tree": ("src/conserta/EDDIMonitor.py", "config"),
    "installed script": ("lib/conserta/RosNode.py", "share/conserta/config"),
    "installed module": (
        "lib/python3/dist-packages/conserta/EDDIMonitor.py",
        "share/conserta/config",
    ),
}


def lay(root, name):
    path = root / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("")
    return path


@pytest.mark.parametrize(("file", "config"), PLACES.values(), ids=PLACES.keys())
def test_found(tmp_path, file, config):
    own = lay(tmp_path, file)
    model = lay(tmp_path, f"{config}/model.json")
    assert find_model(str(own), "conserta") == model.resolve()


@pytest.mark.parametrize(("file", "config"), PLACES.values(), ids=PLACES.keys())
def test_the_model_of_another_package_is_not_taken(tmp_path, file, config):
    own = lay(tmp_path, file)
    lay(tmp_path, "share/consertb/config/model.json")
    lay(tmp_path, "lib/config/model.json")
    with pytest.raises(NoModelFileError) as missing:
        find_model(str(own), "conserta")
    assert str((tmp_path / config).resolve() / "model.json") in str(missing.value)


def test_a_file_near_the_root_of_the_disk():
    with pytest.raises(NoModelFileError):
        find_model("/nowhere.py", "nowhere")
