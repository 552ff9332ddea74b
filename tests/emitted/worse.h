/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef WORSE_H
#define WORSE_H

/* The larger of two errors. fmax would pass over one that is not a number: here it stays. */
static inline double worse(double worst, double error)
{
	return error <= worst || worst != worst ? worst : error;
}

#endif
