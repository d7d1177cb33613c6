"""Sends files to the real OctoPrint, Moonraker and PrusaLink: started by run.sh.

    send.py octoprint|moonraker|prusalink ISOSLICE FOLDER

OctoPrint runs its own virtual printer, and PrusaLink one of ours (mk3.py); both
print the file to its end. Moonraker runs without Klipper first, so that its store
of files is tested, and that a print is refused. With KLIPPER, a folder with
Klipper's sources and the description of its micro-controller, and
KLIPPER_PYTHON it then runs with Klipper, whose commands go nowhere, and prints
the file to its end. FOLDER takes their files. For PrusaLink it must not be in
/tmp, where PrusaLink keeps no files.
"""

import http.client
import json
import os
import pathlib
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request

host, isoslice, folder = *sys.argv[1:3], pathlib.Path(sys.argv[3])
KEY = "0123456789ABCDEF0123456789ABCDEF"
PATIENCE = 240


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def run(*arguments, fails=None, stdin=KEY):
    """Runs isoslice; `fails` is what it is to say if it is to fail."""
    environment = {**os.environ, "ISOSLICE_PROFILES": str(folder / "profiles")}
    done = subprocess.run(
        [isoslice, *arguments], input=stdin, capture_output=True, text=True,
        cwd=folder, env=environment, timeout=PATIENCE,
    )
    said = done.stdout + done.stderr
    assert KEY not in said, said
    if fails is None:
        assert done.returncode == 0, said
    else:
        assert done.returncode == 1 and fails in said, said
    return said


def wait_for(what, test):
    start = time.monotonic()
    while time.monotonic() - start < PATIENCE:
        try:
            if test():
                return
        except (OSError, ValueError, http.client.HTTPException):
            pass
        time.sleep(0.3)
    raise AssertionError(f"{what}: not within {PATIENCE} s")


class Service:
    """A server that ends with the block."""

    def __init__(self, name, command):
        self.log = open(folder / f"{name}.log", "w")
        self.process = subprocess.Popen(
            command, stdout=self.log, stderr=subprocess.STDOUT, cwd=folder)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        # A shell in the background lets its children ignore SIGINT.
        self.process.terminate()
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            # Until it is gone, its port still answers.
            self.process.wait()
        self.log.close()


def get(url, key=KEY):
    request = urllib.request.Request(url, headers={"X-Api-Key": key})
    with urllib.request.urlopen(request, timeout=10) as answer:
        return json.load(answer)


def slice_part():
    flavour = "klipper" if host == "moonraker" else "marlin"
    run("slice", "-q", "-o", "part.gcode",
        "-e", "max(sqrt(x^2 + y^2) - 4, abs(z - 0.5) - 0.5)",
        "--set", "skirt.loops=0", "--set", "speed.travel=300",
        "--set", f"gcode.flavour={flavour}")


def octoprint():
    port = free_port()
    base = folder / "octoprint"
    base.mkdir()
    (base / "config.yaml").write_text(f"""
api: {{key: {KEY}}}
server:
  firstRun: false
  onlineCheck: {{enabled: false}}
  pluginBlacklist: {{enabled: false}}
plugins:
  virtual_printer: {{enabled: true, ambientTemperature: 190}}
  tracking: {{enabled: false}}
  _disabled: [softwareupdate, announcements, pluginmanager, tracking, discovery]
serial: {{port: VIRTUAL, autoconnect: true}}
temperature: {{profiles: []}}
""")
    users = [sys.executable, "-m", "octoprint", "--basedir", str(base), "user",
             "add", "me", "--password", "pass", "--admin"]
    subprocess.run(users, check=True, stdin=subprocess.DEVNULL,
                   capture_output=True)
    command = [sys.executable, "-m", "octoprint", "--basedir", str(base),
               "serve", "--iknowwhatimdoing", "--host", "127.0.0.1",
               "--port", str(port)]
    url = f"http://127.0.0.1:{port}"
    with Service("octoprint", command):
        wait_for("OctoPrint's printer", lambda:
                 get(f"{url}/api/job")["state"] == "Operational")
        add = ["printers", "add", "workshop", "--host", "octoprint", "--url"]
        run(*add, url)
        said = run("printers", "test", "workshop")
        assert "OctoPrint" in said and "ready    yes" in said, said
        run("send", "part.gcode", "--to", "workshop")
        stored = base / "uploads" / "part.gcode"
        sent = (folder / "part.gcode").read_bytes()
        assert stored.read_bytes() == sent
        assert get(f"{url}/api/job")["state"] == "Operational"
        said = run("send", "part.gcode", "--to", "workshop", "--start",
                   "--name", "zwölf Türme.gcode")
        assert "is being printed" in said, said
        wait_for("the print's beginning", lambda:
                 get(f"{url}/api/job")["state"].startswith("Printing"))
        run("send", "part.gcode", "--to", "workshop", "--start",
            fails="cannot start a print now")
        wait_for("the print's end", lambda:
                 get(f"{url}/api/job")["progress"]["completion"] == 100
                 and get(f"{url}/api/job")["state"] == "Operational")
        run(*add, url, "--replace", stdin="wrong")
        run("send", "part.gcode", "--to", "workshop", fails="refuses the key")
        other = ["printers", "add", "other", "--host", "moonraker", "--url"]
        run(*other, url)
        run("printers", "test", "other", fails="is not Moonraker")
    run("printers", "test", "workshop", fails="cannot reach")
    print("ok    OctoPrint stored a file and printed one to its end")


def moonraker():
    port = free_port()
    base = folder / "moonraker"
    for name in ["config", "logs", "gcodes"]:
        (base / name).mkdir(parents=True)
    (base / "config" / "moonraker.conf").write_text(f"""
[server]
host: 127.0.0.1
port: {port}
klippy_uds_address: {base}/klippy.sock

[authorization]
force_logins: false
trusted_clients:

[file_manager]
check_klipper_config_path: False

[machine]
provider: none
validate_service: False
validate_config: False
""")
    command = [sys.executable, "-m", "moonraker", "-d", str(base), "-n"]
    url = f"http://127.0.0.1:{port}"
    with Service("moonraker", command):
        # Its key is in its database, which it shows to nobody without it.
        database = base / "database" / "moonraker-sql.db"

        def answers():
            try:
                get(f"{url}/server/info")
            except urllib.error.HTTPError as error:
                return error.code in (401, 403)
            return True
        wait_for("Moonraker", answers)
        import sqlite3
        with sqlite3.connect(database) as tables:
            key = tables.execute(
                "SELECT password FROM authorized_users "
                "WHERE username = '_API_KEY_USER_'").fetchone()[0]
        add = ["printers", "add", "voron", "--host", "moonraker", "--url", url]
        run(*add, stdin=key)
        run("send", "part.gcode", "--to", "voron")
        sent = (folder / "part.gcode").read_bytes()
        assert (base / "gcodes" / "part.gcode").read_bytes() == sent
        run("send", "part.gcode", "--to", "voron", "--start",
            fails="cannot start a print now")
        if "KLIPPER" in os.environ:
            with_klipper(base, url, key)
        run(*add, "--replace", stdin="wrong")
        run("send", "part.gcode", "--to", "voron", fails="refuses the key")
    print("ok    Moonraker stored a file, and refused to print without Klipper")


def with_klipper(base, url, key):
    """Prints the file to its end with Klipper behind Moonraker."""
    sources = pathlib.Path(os.environ["KLIPPER"])
    config = base / "config" / "printer.cfg"
    here = pathlib.Path(__file__).parent
    card = f"\n[virtual_sdcard]\npath: {base}/gcodes\n"
    config.write_text((here / "klipper.cfg").read_text() + card)
    command = [os.environ["KLIPPER_PYTHON"], sources / "klippy" / "klippy.py",
               config, "-o", "/dev/null", "-d", sources / "out/klipper.dict",
               "-a", base / "klippy.sock", "-I", base / "tty"]

    def ask(path):
        return get(f"{url}/{path}", key)["result"]

    def printed():
        return ask("printer/objects/query?print_stats")["status"]["print_stats"]
    with Service("klipper", command):
        wait_for("Klipper", lambda:
                 ask("server/info")["klippy_state"] == "ready")
        said = run("printers", "test", "voron")
        assert "ready    yes" in said, said
        said = run("send", "part.gcode", "--to", "voron", "--start")
        assert "is being printed" in said, said
        wait_for("the print's end", lambda:
                 printed()["state"] in ("complete", "error"))
        end = printed()
        assert end["state"] == "complete", end
        assert end["filename"] == "part.gcode", end
        assert end["info"]["total_layer"] == 5, end
    print("ok    Moonraker printed a file to its end with Klipper")


def prusalink():
    from mk3 import Printer
    printer = Printer()
    port = free_port()
    base = folder / "prusalink"
    base.mkdir()
    # Printed commands of the file, as PrusaLink sends them.
    text = (folder / "part.gcode").read_text()
    lines = (line.split(";")[0].strip() for line in text.splitlines())
    commands = [line for line in lines if line]
    (base / "prusalink.ini").write_text(f"""
[daemon]
data_dir = {base}
[http]
address = 127.0.0.1
port = {port}
[printer]
port = {printer.port}
[cameras]
auto_detect = False
""")
    (base / "prusa_printer_settings.ini").write_text(f"""
[printer]
type = MK3S
name = printer
location = here
farm_mode = False
network_error_chime = False
[service::local]
enable = 1
username = me
digest = none
api_key = {KEY}
[network]
hostname =
[service::connect]
hostname = localhost
tls = False
port = 0
token =
""")
    command = [sys.executable, "-m", "prusa.link", "--foreground", "--config",
               str(base / "prusalink.ini"), "start"]
    url = f"http://127.0.0.1:{port}"
    stored = base / "PrusaLink gcodes" / "part.gcode"
    state = lambda: get(f"{url}/api/v1/status")["printer"]["state"]
    with Service("prusalink", command):
        wait_for("PrusaLink's printer", lambda: state() == "IDLE")
        add = ["printers", "add", "mk3", "--host", "prusalink", "--url", url]
        run(*add)
        said = run("printers", "test", "mk3")
        assert "PrusaLink" in said and "ready    yes" in said, said
        run("send", "part.gcode", "--to", "mk3")
        assert stored.read_bytes() == (folder / "part.gcode").read_bytes()
        assert not printer.commands and state() == "IDLE"
        said = run("send", "part.gcode", "--to", "mk3", "--start")
        assert "is being printed" in said, said
        wait_for("the print's end", lambda: state() == "FINISHED")
        printed = [c for c in printer.commands if c in set(commands)]
        assert printed == commands, (len(printed), len(commands))
        run(*add, "--replace", stdin="wrong")
        run("send", "part.gcode", "--to", "mk3", fails="refuses the key")
    run("printers", "test", "mk3", fails="cannot reach")
    print("ok    PrusaLink stored a file, and printed it to its end")


slice_part()
{"octoprint": octoprint, "moonraker": moonraker, "prusalink": prusalink}[host]()
