#!/bin/sh
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
# Debian's broker, with the settings next to this file.
exec mosquitto -c "$(dirname "$0")/mosquitto.conf"
