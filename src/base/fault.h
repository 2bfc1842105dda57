/* Failures on demand, for tests: in builds with GRAY_FAULTS every allocation and every system call that can fail is
 * counted, over both processes of a run in the order in which they happen, and one of them can be made to fail by its
 * number: GRAY_FAIL_ALLOC=k or GRAY_FAIL_CALL=k in the environment, GRAY_FAULT_COUNT=FILE writes their number,
 * GRAY_FAIL_ERRNO=n is the error of a failing call (default EIO). Other builds have none of this. */
#ifndef GRAY_BASE_FAULT_H
#define GRAY_BASE_FAULT_H

#include <errno.h>
#include <stdbool.h>
#include <stdint.h>

enum fault_kind { FAULT_OF_ALLOCATION, FAULT_OF_CALL };

#ifdef GRAY_FAULTS
/* Counts; true when this one is to fail. */
bool fault_now(enum fault_kind kind);
/* From now on number `number` (1 is the next) fails once; 0 turns it off. */
void fault_at(enum fault_kind kind, uint64_t number);
uint64_t fault_count(enum fault_kind kind);
/* Sets errno for calls that are made to fail; 0 changes nothing. Returns the previous value. */
int fault_errno(int number);
/* Calls `interfere` just before the system call with that number (1 is the next), in the role of another process. */
void fault_before(uint64_t number, void (*interfere)(void));
/* This process and its later children count separately from the others, from 0, and no call fails. */
void fault_apart(void);
#else
static inline bool fault_now(enum fault_kind kind) {
    (void)kind;
    return false;
}
static inline void fault_at(enum fault_kind kind, uint64_t number) {
    (void)kind;
    (void)number;
}
static inline uint64_t fault_count(enum fault_kind kind) {
    (void)kind;
    return 0;
}
static inline int fault_errno(int number) {
    (void)number;
    return EIO;
}
static inline void fault_before(uint64_t number, void (*interfere)(void)) {
    (void)number;
    (void)interfere;
}
static inline void fault_apart(void) {
}
#endif

/* A call that returns a negative number, or a null pointer, when it fails. */
#define MAY_FAIL(call) (fault_now(FAULT_OF_CALL) ? (errno = fault_errno(0), -1) : (call))
#define MAY_GIVE_NULL(call) (fault_now(FAULT_OF_CALL) ? (errno = fault_errno(0), NULL) : (call))

#endif
