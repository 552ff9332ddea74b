/* SPDX-License-Identifier: MIT-0 */
/* numbers.h: with what begins what a model's file includes for its steps: the type of its numbers, `real`, and the
 * runtime's names for it, until undef.h: the next model in a file may have another one.  PL_SINGLE: float, else double.
 * Constants are integers, or cast: no float is promoted.
 *
 * What the file defines before each of them, beside what the head of each lists:
 *
 *     PL(name), PL_SINGLE        the prefix of the model before a name; 1: in float
 *     PL_TYPE, PL_H              the model; its step [s]
 *     PL_STATES, PL_INPUTS, PL_OUTPUTS, PL_PARAMS    how many, where there are any or they are read */
#include "plrt.h"

#ifdef PL /* What the file of a model does not define: it has none of it, and one segment of time */
#ifndef PL_REFRESHED
#define PL_REFRESHED 0
#endif
#ifndef PL_BESIDE
#define PL_BESIDE 0
#endif
#ifndef PL_BLOCKS
#define PL_BLOCKS 0
#endif
#ifndef PL_BOUNCES
#define PL_BOUNCES 0
#endif
#ifndef PL_AROUND
#define PL_AROUND 0
#endif
#ifndef PL_BY_VALUES
#define PL_BY_VALUES 0
#endif
#ifndef PL_CARRIES
#define PL_CARRIES 0
#endif
#ifndef PL_CHANGING
#define PL_CHANGING 0
#endif
#ifndef PL_CHOICES
#define PL_CHOICES 0
#endif
#ifndef PL_DECAYING
#define PL_DECAYING 0
#endif
#ifndef PL_FLUSHES
#define PL_FLUSHES 0
#endif
#ifndef PL_FLUSHES_BESIDE
#define PL_FLUSHES_BESIDE 0
#endif
#ifndef PL_EVENTS
#define PL_EVENTS 0
#endif
#ifndef PL_EVENT_FREE
#define PL_EVENT_FREE 0
#endif
#ifndef PL_HELD
#define PL_HELD 0
#endif
#ifndef PL_COUNTS
#define PL_COUNTS(i) 1
#endif
#ifndef PL_FOLLOWED
#define PL_FOLLOWED 0
#endif
#ifndef PL_ALIGNED
#define PL_ALIGNED 0
#endif
#ifndef PL_MOVED
#define PL_MOVED 0
#endif
#ifndef PL_CONTACTS
#define PL_CONTACTS 0
#endif
#ifndef PL_CONSTRAINTS
#define PL_CONSTRAINTS 0
#endif
#ifndef PL_CONSERVES
#define PL_CONSERVES 0
#endif
#ifndef PL_CONVERTED
#define PL_CONVERTED 0
#endif
#ifndef PL_SCALED
#define PL_SCALED 0
#endif
#ifndef PL_SEEDED
#define PL_SEEDED 0
#endif
#ifndef PL_SLOPED
#define PL_SLOPED 0
#endif
#ifndef PL_DECLARED
#define PL_DECLARED 0
#endif
#ifndef PL_BY_ROWS
#define PL_BY_ROWS 0
#endif
#ifndef PL_BY_PHI
#define PL_BY_PHI 0
#endif
#ifndef PL_SLOTS
#define PL_SLOTS 0
#endif
#ifndef PL_SWITCHING_FUNCTIONS
#define PL_SWITCHING_FUNCTIONS 0
#endif
#ifndef PL_FEW
#define PL_FEW 0
#endif
#ifndef PL_FLOORS
#define PL_FLOORS 0
#endif
#ifndef PL_FORCED
#define PL_FORCED 0
#endif
#ifndef PL_ENVELOPES
#define PL_ENVELOPES 0
#endif
#ifndef PL_GUARDS
#define PL_GUARDS 0
#endif
#ifndef PL_HALVINGS
#define PL_HALVINGS 0
#endif
#ifndef PL_IMPACTS
#define PL_IMPACTS 0
#endif
#ifndef PL_INPUTS
#define PL_INPUTS 0
#endif
#ifndef PL_INSIDE
#define PL_INSIDE 0
#endif
#ifndef PL_IN_STEP
#define PL_IN_STEP 0
#endif
#ifndef PL_JUMPS
#define PL_JUMPS 0
#endif
#ifndef PL_COLUMNS_D
#define PL_COLUMNS_D 0
#endif
#ifndef PL_COMPENSATED
#define PL_COMPENSATED 0
#endif
#ifndef PL_LANES_PAY
#define PL_LANES_PAY 0
#endif
#ifndef PL_LARGEST
#define PL_LARGEST 0
#endif
#ifndef PL_LEADS
#define PL_LEADS 0
#endif
#ifndef PL_LOAD_STATES
#define PL_LOAD_STATES 0
#endif
#ifndef PL_LOSES
#define PL_LOSES 0
#endif
#ifndef PL_MEASURED
#define PL_MEASURED 0
#endif
#ifndef PL_MODAL
#define PL_MODAL 0
#endif
#ifndef PL_MODES
#define PL_MODES 0
#endif
#ifndef PL_MOMENTA
#define PL_MOMENTA 0
#endif
#ifndef PL_INDEFINITE
#define PL_INDEFINITE 0
#endif
#ifndef PL_MASSES
#define PL_MASSES 0
#endif
#ifndef PL_NORMAL
#define PL_NORMAL 0
#endif
#ifndef PL_OUT_ALONE
#define PL_OUT_ALONE 0
#endif
#ifndef PL_OPENCL
#define PL_OPENCL 0
#endif
#ifndef PL_CUDA
#define PL_CUDA 0
#endif
#ifndef PL_OUT_SIZE
#define PL_OUT_SIZE 0
#endif
#ifndef PL_TUNED
#define PL_TUNED 0
#endif
#ifndef PL_OVER
#define PL_OVER 0
#endif
#ifndef PL_OWN
#define PL_OWN 0
#endif
#ifndef PL_PARAMS
#define PL_PARAMS 0
#endif
#ifndef PL_PEAKS
#define PL_PEAKS 0
#endif
#ifndef PL_PHASES
#define PL_PHASES 0
#endif
#ifndef PL_PLACES
#define PL_PLACES 0
#endif
#ifndef PL_RAMPS
#define PL_RAMPS 0
#endif
#ifndef PL_RANGES
#define PL_RANGES 0
#endif
#ifndef PL_RELATIVE
#define PL_RELATIVE 0
#endif
#ifndef PL_ROWS
#define PL_ROWS 0
#endif
#ifndef PL_SAMPLED
#define PL_SAMPLED 0
#endif
#ifndef PL_SEGMENTS
#define PL_SEGMENTS 1
#endif
#ifndef PL_SHARES
#define PL_SHARES 0
#endif
#ifndef PL_SINGLE
#define PL_SINGLE 0
#endif
#ifndef PL_SLOPES
#define PL_SLOPES 0
#endif
#ifndef PL_STATUS
#define PL_STATUS 0
#endif
#ifndef PL_STRAIGHT
#define PL_STRAIGHT 0
#endif
#ifndef PL_PAST_SAMPLES
#define PL_PAST_SAMPLES 0
#endif
#ifndef PL_TERMS
#define PL_TERMS 0
#endif
#ifndef PL_UNRESOLVED
#define PL_UNRESOLVED 0
#endif
#ifndef PL_WATCHED
#define PL_WATCHED 0
#endif
#ifndef PL_WHOLE
#define PL_WHOLE 0
#endif
#endif

#if PL_SINGLE
#define real float
#include "floats.h"
#else
#define real double
#endif
