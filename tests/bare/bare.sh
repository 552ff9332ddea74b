#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A Debian that has nothing but make and git, and a stranger in it who follows README and tutorial: what they lack, and
# how long it takes. Root's work: debootstrap makes the system in FOLDER, in namespaces of its own, so that no mount and
# no process is left.
#
#     bare.sh FOLDER REPOSITORY [check]           # with check: `make check` at the end, half an hour
#
# FOLDER/bare.md has the log, FOLDER/said what all commands said. SUITE (bookworm) and MIRROR
# (http://deb.debian.org/debian) in the environment choose another Debian. FOLDER/base is kept for the next time.
set -eu
folder=$1
repository=$2
suite=${SUITE:-bookworm}
mirror=${MIRROR:-http://deb.debian.org/debian}
here=$(cd "${0%/*}" && pwd)

for program in debootstrap unshare chroot git; do
	command -v $program >/dev/null || { echo "1..0 # SKIP no $program"; exit 0; }
done
[ "$(id -u)" = 0 ] || { echo '1..0 # SKIP only root can make a system in a folder'; exit 0; }
unshare -mpf --mount-proc true 2>/dev/null || { echo '1..0 # SKIP no namespaces'; exit 0; }

mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
alone='unshare -mpf --mount-proc --propagation private'
if [ ! -f "$folder/base/made" ]; then
	rm -rf --one-file-system "$folder/base"
	$alone debootstrap --variant=minbase --include=make,git,ca-certificates "$suite" "$folder/base" "$mirror" \
		>"$folder/debootstrap.log" || { tail -n 5 "$folder/debootstrap.log"; exit 1; }
	touch "$folder/base/made"
fi
rm -rf --one-file-system "$folder/root"
cp -a "$folder/base" "$folder/root"
git clone -q --bare "$repository" "$folder/root/srv/plgen.git"
cp "$here/stranger.sh" "$here/../docs/blocks.awk" "$folder/root/root"
status=0
# shellcheck disable=SC2016
$alone sh -c 'mount -t proc proc "$1/proc" && exec chroot "$1" /usr/bin/env -i HOME=/root LC_ALL=C.UTF-8 \
	PATH=/usr/sbin:/usr/bin:/sbin:/bin sh /root/stranger.sh $2' sh "$folder/root" "${3:-}" || status=$?
cp "$folder/root/root/bare.md" "$folder/root/root/said" "$folder"
exit $status
