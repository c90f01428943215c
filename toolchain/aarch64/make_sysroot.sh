#!/usr/bin/env bash
# Makes a folder of Debian 12 for arm64 to build and run against, of the packages in packages.txt: fetched and verified by apt, unpacked, never installed;
# this machine's own list of packages stays as it is. Needs no root. Does nothing where the folder is up to date.
# Usage: toolchain/aarch64/make_sysroot.sh FOLDER
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
[ $# -eq 1 ] || { sed -n 's/^# Usage: /usage: /p' "$0" >&2; exit 2; }
mkdir -p "$1"
root=$(cd "$1" && pwd)
made_of=$root/made_of
if cat "$here/packages.txt" "$0" | cmp -s - "$made_of"; then
  exit 0
fi
if [ -n "$(ls -A "$root")" ] && [ ! -e "$made_of" ]; then
  echo "make_sysroot: $root has other files in it" >&2
  exit 1
fi
for program in apt-get dpkg-deb readelf; do
  command -v $program >/dev/null || { echo "make_sysroot: no $program: this needs a Debian machine with binutils" >&2; exit 1; }
done

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
find "$root" -mindepth 1 ! -path "$made_of" -delete
: >"$made_of"  # whose folder this is; filled when it is whole

mkdir -p "$work"/{state/lists/partial,cache/archives/partial,deb}
: >"$work/state/status"
cat >"$work/apt.conf" <<CONF
APT::Architecture "arm64";
APT::Architectures { "arm64"; };
APT::Install-Recommends "false";
APT::Sandbox::User "root";
Dir::State "$work/state";
Dir::State::status "$work/state/status";
Dir::Cache "$work/cache";
CONF
export APT_CONFIG=$work/apt.conf
mapfile -t whole < <(sed 's/#.*//' "$here/packages.txt" | awk 'NF == 1 {print $1}')
mapfile -t alone < <(sed 's/#.*//' "$here/packages.txt" | awk '$2 == "alone" {print $1}')
echo "make_sysroot: fetching ${#whole[@]} arm64 packages with what they depend on, ${#alone[@]} without"
apt-get update -qq
apt-get install -y -qq --download-only "${whole[@]}" >/dev/null
(cd "$work/deb" && apt-get download -qq "${alone[@]}")

# As on an installed system, /lib is a link to /usr/lib.
mkdir -p "$root/usr/lib" "$root/usr/bin" "$root/usr/sbin"
for folder in lib bin sbin; do ln -s usr/$folder "$root/$folder"; done
for package in "$work"/cache/archives/*.deb "$work"/deb/*.deb; do
  dpkg-deb --fsys-tarfile "$package" | tar -x -C "$root" --keep-directory-symlink --no-same-owner --exclude='./usr/share/doc' --exclude='./usr/share/man' \
    --exclude='./usr/share/locale'
  # Which package a program needs for which library: make_packages.sh reads it.
  dpkg-deb --ctrl-tarfile "$package" | tar -xO ./shlibs >>"$root/shlibs" 2>/dev/null || true
done

libraries=$root/usr/lib/aarch64-linux-gnu
# What the packages' scripts would have set up: which BLAS and LAPACK there is.
ln -sf blas/libblas.so.3 "$libraries/libblas.so.3"
ln -sf lapack/liblapack.so.3 "$libraries/liblapack.so.3"
# Links that begin at / would leave the folder.
find "$root" -type l -lname '/*' -printf '%p %l\n' | while read -r link target; do
  ln -sfn "$(realpath -sm --relative-to="$(dirname "$link")" "$root$target")" "$link"
done
# OpenCV's CMake files insist that each of its libraries is there, also those that nobody links: an empty file is enough for them.
sed -n 's|.*IMPORTED_LOCATION[A-Z_]* "${_IMPORT_PREFIX}\(/[^"]*\)".*|\1|p' "$libraries"/cmake/opencv4/OpenCVModules*.cmake | while read -r library; do
  [ -e "$root/usr$library" ] || : >"$root/usr$library"
done

# What is linked has to be whole.
declare -A seen=()
whole_library() {
  local file=$libraries/$1 needed
  [ -e "$file" ] || file=$root/usr/lib/$1
  [ -z "${seen[$1]:-}" ] || return 0
  seen[$1]=1
  [ -s "$file" ] || { echo "make_sysroot: $1 is missing, needed by $2" >&2; return 1; }
  while read -r needed; do whole_library "$needed" "$1"; done < <(readelf -d "$file" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' | grep -v '^ld-linux')
}
for library in libopencv_calib3d.so.406 libopencv_imgcodecs.so.406 libpcl_segmentation.so.1.13 libpcl_filters.so.1.13 libapriltag.so.3 libyaml-cpp.so.0.7 \
  libtinyxml2.so.9 liborocos-kdl.so.1.5; do
  whole_library "$library" packages.txt
done
cat "$here/packages.txt" "$0" >"$made_of"
echo "make_sysroot: $root is ready, $(du -sh "$root" | cut -f1)"
