/* In front of libc: the clock on the wall jumps by an hour and back, every second. */
#define _GNU_SOURCE
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

static long jump(void) {
    static const long by_s[] = {0, 3600, -3600, 86400, -86400};
    struct timespec now;
    syscall(SYS_clock_gettime, CLOCK_MONOTONIC, &now);
    return by_s[now.tv_sec % 5];
}

int clock_gettime(clockid_t clock, struct timespec *t) {
    int code = (int)syscall(SYS_clock_gettime, clock, t);
    if (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE) t->tv_sec += jump();
    return code;
}

int gettimeofday(struct timeval *restrict t, void *restrict zone) {
    int code = (int)syscall(SYS_gettimeofday, t, zone);
    t->tv_sec += jump();
    return code;
}

time_t time(time_t *t) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    if (t) *t = now.tv_sec;
    return now.tv_sec;
}
