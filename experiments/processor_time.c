/* SPDX-License-Identifier: BSD-3-Clause
 * Preloaded, steady clocks and the process's tell the processor time of the thread that asks: what
 * others do on the machine meanwhile is not in it, nor what other threads do. One that waits by a
 * steady clock, to say how far a run is, does not sleep. For work of one thread.
 *
 *   cc -O2 -shared -fPIC experiments/processor_time.c -o processor_time.so
 *   LD_PRELOAD=$PWD/processor_time.so build/release/bvlab replay ...
 */
#define _GNU_SOURCE
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

int clock_gettime(clockid_t clock, struct timespec *time) {
  if (clock == CLOCK_MONOTONIC || clock == CLOCK_PROCESS_CPUTIME_ID) clock = CLOCK_THREAD_CPUTIME_ID;
  return (int)syscall(SYS_clock_gettime, clock, time);
}
