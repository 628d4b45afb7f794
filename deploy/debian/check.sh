#!/usr/bin/env bash
# Installs the packages of folder $1 in a clean Debian root, as root, and starts each program. The server's package is
# first tested alone, so that the server cannot use libraries that another package installs. It draws a picture for the
# Python client. The desktop client shows a picture on a virtual display.
set -euo pipefail
export DEBIAN_FRONTEND=noninteractive
packages=$(realpath "$1")
root=$(mktemp -d "${TMPDIR:-/var/tmp}/thunderhead-root.XXXXXX")
trap 'rm -rf "$root"' EXIT

# The bare system is saved next to the packages, so that the next run can reuse it.
base=$packages/../packages-root.tar
[ -f "$base" ] || mmdebstrap --mode=root --variant=apt --include=ca-certificates bookworm "$base"
tar -C "$root" -xf "$base"
cp /etc/resolv.conf "$root/etc/" 2>/dev/null || true
mount -t proc proc "$root/proc"
trap 'umount "$root/proc"; rm -rf "$root"' EXIT
chroot "$root" apt-get update -qq
cp "$packages"/*.deb "$root/root/"
cat > "$root/root/serve.sh" <<'END'
thunderhead serve --data /usr/share/thunderhead/samples --http 127.0.0.1:58080 --grpc 127.0.0.1:58051 --state none >/tmp/serve.log 2>&1 &
server=$!
# The server's log is printed only if something fails.
trap 'status=$?; [ $status = 0 ] || cat /tmp/serve.log; kill $server 2>/dev/null || true; exit $status' EXIT
for _ in $(seq 120); do grep -q http:// /tmp/serve.log || ! kill -0 $server 2>/dev/null && break; sleep 1; done
grep -q http:// /tmp/serve.log || { echo "the server has ended, or is not ready after two minutes" >&2; exit 1; }
END
# The shell inside the root expands the file names.
add() { chroot "$root" sh -c "apt-get install -y -qq --no-install-recommends $1 >/dev/null"; }
add '/root/thunderhead_*.deb'
chroot "$root" sh -euc '
  id thunderhead >/dev/null
  thunderhead --version
  test -f /usr/lib/systemd/system/thunderhead.service
  grep -q "^libboost" /usr/share/doc/thunderhead/third-party-notices.txt
  test -f /usr/share/thunderhead/page/third-party-notices.txt
  . /root/serve.sh
'
add 'xvfb xauth /root/*.deb'
chroot "$root" grep -q ^libimgui /usr/share/doc/thunderhead-desktop/third-party-notices.txt
chroot "$root" sh -euc '
  . /root/serve.sh
  python3 -c "
import thunderhead
with thunderhead.Client(\"127.0.0.1:58051\") as client:
    picture = client.render(size=(160, 90))
    assert picture.size == (160, 90), picture.size
    assert picture.getextrema()[0][1] > 40, picture.getextrema()
    print(\"Python client: a picture of\", client.storms()[0].title)
"
  xvfb-run -a -s "-screen 0 640x400x24" thunderhead-desktop 127.0.0.1:58051 --width 640 --height 400 --seconds 20 | tee /tmp/desktop.log
  grep -Eq "^[1-9][0-9]* pictures" /tmp/desktop.log
'
echo "the packages install and start"
