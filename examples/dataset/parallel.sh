#!/bin/sh
# A data set by GNU parallel, two processes at a time: parallel.sh SET SHARDS
exec parallel --jobs 2 panwright dataset run "$1" --threads 1 --shard "{}/$2" ::: $(seq 0 $(($2 - 1)))
