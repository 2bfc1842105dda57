/* What the decisions of a path say about its numbers. */
#ifndef GRAY_RECORD_RECORD_INTERVAL_INTERNAL_H
#define GRAY_RECORD_RECORD_INTERVAL_INTERNAL_H

#include "record/record_internal.h"

void record_interval_end(struct recorder *recorder);
/* 1 if the condition holds for all points of the path, 0 if it holds for none, -1 if for some or not known. */
int record_interval_prove(const struct recorder *recorder, uint32_t condition);
/* On the path, the decision has its answer from now on. False: no memory. */
bool record_interval_narrow(struct recorder *recorder, struct decision *decision);

#endif
