#!/usr/bin/env python3
"""Fails when a layer includes what it must not. Usage: layers.py SOURCE_DIR

Dependencies run one way (docs/architecture.md). Each layer lists what of the project it may include; the core's layers list also which
system headers they may, everything else is refused.
"""
import pathlib
import re
import sys

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)

SHARED_FOR_CORE = ["shared/messages/", "shared/geometry/", "shared/lanes/", "shared/can/", "shared/calibration/", "shared/panel/panel_layout.hpp",
                   "shared/arm/arm_geometry.hpp", "shared/arm/arm_model.hpp", "shared/random.hpp"]
CORE_HEADERS = {"algorithm", "array", "atomic", "bit", "cmath", "compare", "concepts", "cstddef", "cstdint", "cstring", "limits", "numbers",
                "numeric", "optional", "span", "tuple", "type_traits", "utility", "variant", "Eigen/Core", "Eigen/Geometry", "Eigen/Dense", "Eigen/LU",
                "Eigen/Cholesky", "Eigen/Eigenvalues", "Eigen/QR", "Eigen/SVD"}

# layer (longest prefix wins): project paths it may include, and patterns of system headers only it may include
LAYERS = {
    "shared/": ["shared/"],
    "firmware/": ["firmware/"] + SHARED_FOR_CORE,
    "hal/ports.hpp": ["firmware/", "shared/"],
    "hal/core_loop.hpp": ["firmware/", "shared/", "hal/"],
    "hal/lockstep.hpp": ["firmware/", "shared/", "hal/"],
    "hal/heap_guard/": ["hal/heap_guard/"],
    "hal/mock/": ["hal/mock/", "hal/ports.hpp", "firmware/", "shared/"],
    "hal/vision/": ["hal/vision/", "firmware/", "shared/"],
    "hal/command_line/": ["hal/command_line/", "hal/config/", "shared/"],
    "hal/vehicle/": ["hal/vehicle/", "hal/command_line/", "hal/config/", "hal/vision/", "hal/heap_guard/", "hal/ports.hpp", "hal/core_loop.hpp", "firmware/", "shared/"],
    "hal/config/": ["hal/config/", "hal/vision/", "firmware/", "shared/"],
    "hal/sim/": ["hal/", "firmware/", "shared/", "host_sim/world/", "host_sim/optics/", "host_sim/devices/"],
    "host_sim/world/": ["host_sim/world/", "shared/"],
    "host_sim/optics/": ["host_sim/optics/", "shared/"],
    "host_sim/devices/": ["host_sim/devices/", "shared/"],
    "host_sim/record/": ["host_sim/record/", "hal/vision/", "firmware/", "shared/"],
    "host_sim/campaign/": ["host_sim/campaign/", "host_sim/record/", "shared/"],
    "host_sim/scenario/": ["hal/config/", "host_sim/scenario/", "host_sim/world/", "host_sim/optics/", "host_sim/devices/", "hal/sim/sim_config.hpp",
                           "hal/vision/", "firmware/", "shared/"],
    "host_sim/judge/": ["host_sim/judge/", "host_sim/scenario/", "host_sim/world/", "host_sim/devices/", "hal/config/", "hal/sim/", "firmware/", "shared/"],
    "host_sim/serve/": ["host_sim/serve/", "host_sim/scenario/", "host_sim/record/", "host_sim/world/", "host_sim/optics/", "host_sim/devices/",
                        "hal/sim/", "hal/vehicle/", "hal/ports.hpp", "firmware/", "shared/"],
    "host_sim/app/": ["host_sim/", "hal/", "firmware/", "shared/", "tests/bench/"],
}
# who alone may know a library
OWNERS = {
    r"^(btBullet|BulletDynamics|BulletCollision|LinearMath)": ["host_sim/world/"],
    r"^embree": ["host_sim/optics/"],
    r"^pcl/": ["hal/vision/", "host_sim/record/"],
    r"^apriltag": ["hal/vision/", "host_sim/optics/"],
    r"^opencv2/": ["hal/vision/", "host_sim/record/", "host_sim/optics/", "host_sim/app/"],
    # Whoever links them waits for some 220 libraries at every start; png.cpp knows their constants alone.
    r"^opencv2/(imgcodecs|videoio|highgui)": ["hal/vision/codecs/codecs_module", "host_sim/record/png"],
    r"^linux/|^sys/socket|^net/": ["hal/vehicle/", "host_sim/serve/v4l2_target"],
    # POSIX beside those: the vehicle's side, the desktop program's processes and terminal, the files shared with other processes, and the one that has to reach the disk.
    r"^(unistd|fcntl|poll|sched|pthread|pwd|grp|termios|dirent|dlfcn|ifaddrs|syslog|signal)\.h$|^csignal$|^sys/|^netinet/|^arpa/":
        ["hal/vehicle/", "host_sim/app/", "host_sim/serve/come_first", "host_sim/serve/serve_orders", "host_sim/serve/v4l2_target", "shared/frame_ring/mapped_file",
         "shared/frame_ring/shared_file",
         "hal/config/homing_file", "host_sim/record/folder_in_writing",  # fsync, flock
         "hal/vision/codecs/picture_codecs"],  # dlopen
    r"^kdl/": [],
}


def layer_of(path):
    return max((p for p in LAYERS if path.startswith(p)), key=len, default=None)


def faults(root):
    for top in ("shared", "firmware", "hal", "host_sim"):
        for file in sorted((root / top).rglob("*")):
            if file.suffix not in (".hpp", ".cpp", ".h"):
                continue
            path = file.relative_to(root).as_posix()
            layer = layer_of(path)
            if layer is None:
                yield f"{path}: belongs to no layer of tests/house/layers.py"
                continue
            for kind, header in INCLUDE.findall(file.read_text()):
                if kind == '"':
                    if not any(header.startswith(allowed) for allowed in LAYERS[layer]):
                        yield f"{path}: {layer} must not include {header}"
                    continue
                if layer == "firmware/" and header not in CORE_HEADERS:
                    yield f"{path}: the core must not include <{header}>"
                for pattern, owners in OWNERS.items():
                    if re.search(pattern, header) and not any(path.startswith(owner) for owner in owners):
                        yield f"{path}: <{header}> is not this layer's"


def main():
    found = list(faults(pathlib.Path(sys.argv[1])))
    print("\n".join(found) or "every layer includes only what it may")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
