#!/bin/sh
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
# Publishes the time, ten times a second, to the broker at the given address.
sleep 0.5
i=0
while [ $i -lt 10 ]; do
  date +%s.%N
  i=$((i + 1))
  sleep 0.1
done | mosquitto_pub -h "$1" -t feeder/power -q 1 -l
