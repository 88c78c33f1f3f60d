#!/usr/bin/env bash
# The patches of a campaign, made once: patches.sh CAMPAIGN FOLDER
set -euo pipefail
[ -e "$2/certificate.json" ] || exec "$GONIO" surface "$1" -o "$2"
