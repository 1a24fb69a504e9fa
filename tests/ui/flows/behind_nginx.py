"""The console below a path of a web server that has TLS, by the configuration that the documentation has for that."""

import asyncio
import contextlib
import os
import re
import shutil
import subprocess
from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from tests.support.console_page import until
from tests.support.real_gateway import free_port
from tests.ui.browser import chromium, hold, open_page, show, until_so, wait_for
from tests.unit.gateway.rig import Opening

pytestmark = [pytest.mark.real_clock, pytest.mark.shares_descriptors]
DOCUMENTED = Path(__file__).parents[3] / "docs" / "examples" / "nginx" / "robotd.conf"
_SERVER = """daemon off; master_process off; pid {folder}/pid; error_log {folder}/error.log;
events {{}}
http {{
  access_log {folder}/access.log;
  client_body_temp_path {folder}/body; proxy_temp_path {folder}/proxy; fastcgi_temp_path {folder}/fastcgi;
  uwsgi_temp_path {folder}/uwsgi; scgi_temp_path {folder}/scgi;
  server {{
    listen 127.0.0.1:{port} ssl;
    ssl_certificate {folder}/cert.pem; ssl_certificate_key {folder}/key.pem;
{location}
  }}
}}
"""


def tool(name: str) -> str:
    """Return a program; where it is absent the flow is skipped, and where everything has to be there it fails."""
    found = shutil.which(name, path=f"{os.environ['PATH']}:/usr/sbin")
    if found is None and "CI" in os.environ:
        pytest.fail(f"no {name}: apt-get install nginx-light openssl")
    if found is None:
        pytest.skip(f"no {name}: apt-get install nginx-light openssl")
    return found


@contextlib.asynccontextmanager
async def nginx(folder: Path, location: str) -> AsyncIterator[str]:
    """Serve with TLS, and yield the address."""
    _certify(folder)
    port = free_port()
    (folder / "nginx.conf").write_text(_SERVER.format(folder=folder, port=port, location=location))
    process = await asyncio.create_subprocess_exec(tool("nginx"), "-p", str(folder), "-c", str(folder / "nginx.conf"))
    try:
        await until(lambda: _listens(port))
        yield f"https://127.0.0.1:{port}/"
    finally:
        process.terminate()
        await process.wait()


def _certify(folder: Path) -> None:
    """Make a key, and a certificate that no browser trusts."""
    key = ("req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=127.0.0.1")
    files = ("-keyout", folder / "key.pem", "-out", folder / "cert.pem")
    subprocess.run([tool("openssl"), *key, *files], capture_output=True, check=True)


def _listens(port: int) -> bool:
    listening = Path("/proc/net/tcp").read_text()
    return f"0100007F:{port:04X} 00000000:0000 0A" in listening


async def test_the_console_works_below_a_path_with_tls(opening: Opening, tmp_path: Path) -> None:
    folder = tmp_path / "nginx"
    folder.mkdir()
    async with opening(trusted_proxies=("127.0.0.1",)) as rig:
        location, changed = re.subn(r"127\.0\.0\.1:8470", f"127.0.0.1:{rig.address.port}", DOCUMENTED.read_text())
        assert changed == 1
        async with nginx(folder, location) as address, chromium() as browser:
            page = await open_page(browser, rig, "admin", address=f"{address}dusty/", ignore_https_errors=True)
            await wait_for(page, ".age", "live")
            cookie = (await page.context.cookies())[0]
            assert (cookie["path"], cookie["secure"], cookie["httpOnly"]) == ("/dusty/", True, True)
            assert cookie["sameSite"] == "Strict"
            await hold(page, "Hold to arm", 1400)
            await until(lambda: rig.control.armed)
            await page.keyboard.press("Escape")
            await wait_for(page, ".stop", "STOPPED in")
            assert not rig.control.armed
            await show(page, "maps")
            picture = page.locator(".maps img").first
            await picture.wait_for()
            await until_so(page, "document.querySelector('.maps img').naturalWidth > 0")
            for connection in tuple(rig.house.connections):
                connection.finish("the proxy cuts")
            await page.wait_for_timeout(200)
            await wait_for(page, ".age", "live")
            await page.goto(f"{address}dusty/stop")
            await page.get_by_role("button", name="STOP").click()
            await wait_for(page, "[role=status]", "STOPPED in")
            outside = await page.context.request.post(f"{address}dusty/api/command/arm", data={})
            assert outside.status == 403, "not of our page"
            assert {deed.whence for deed in rig.house.services.audit.all} == {"127.0.0.1"}
            assert [text for text in page.complaints if "403" not in text] == []
