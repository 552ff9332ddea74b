/* SPDX-License-Identifier: MIT-0 */
/* kernel.h: NAME_kernel, many steps of many instances on a device, for OpenCL, CUDA and OpenMP: each work item steps
 * one instance of NAME_batch, by the sums of its lanes or by NAME_step.  What instances share comes from
 * NAME_batch_share on the host.  Included by the file of the kernel, which defines before it
 *
 *     PL_OPENCL, PL_CUDA         1: for that; else for OpenMP
 *     PL_ROWS, PL_STEPPED        numbers of an instance, of these those that lanes step
 *     PL_OUTPUTS                 outputs
 *     PL_SHARED, PL_LANES        numbers of a step that instances share; that params decide, of an instance
 *     PL_OVER, PL_STATES         steps of a series of fixed order, series_lanes.h, and states; 0: none
 *
 * and where each takes its sums by lanes
 *
 *     PL_FLUSHES                 above 0: decayed states become 0, by PL(flush) on PL(flushed) of flush.h
 *     pl_lanes                   a number, of which there is one in each work item
 *
 * and behind it PL(lanes_step), or PL(lanes_pass), and PL(lanes_out), as batch.h has them; or, by PL_WHOLE, all that
 * PL(step) and PL(out) take, and
 *
 *     PL_INPUTS                  of a step
 *     PL_HEAD                    bytes at the head of PL_TYPE that instances share, in each row before inputs; 0: none
 *     PL_EVENTS                  1: regions of lanes, whose contact and status stand behind the states
 *     PL_PEAKS, PL(peak_output)[]    outputs that are the largest of something, in linear steps
 *     PL(factor_at)[]            where in PL_TYPE each of what params decide is */
#include "numbers.h"

#if PL_OPENCL
#define PL_GLOBAL __global
#define PL_OWN_FUNCTION static
#define PL_KERNEL __kernel void
#define PL_SIZE_TYPE ulong
#elif PL_CUDA
#define PL_GLOBAL
#define PL_OWN_FUNCTION static __device__ inline
#define PL_KERNEL extern "C" __global__ void
#define PL_SIZE_TYPE unsigned long long
#else
#define PL_GLOBAL
#define PL_OWN_FUNCTION static inline
#define PL_KERNEL void
#define PL_SIZE_TYPE unsigned long long
#endif
#define PL_HAS(count) ((count) > 0 ? (count) : 1) /* no array is empty */

#if !PL_WHOLE
/* As pl_accumulate of the runtime */
PL_OWN_FUNCTION pl_lanes pl_lanes_accumulate(pl_lanes sum, pl_lanes term, pl_lanes small, pl_lanes *low)
{
	const pl_lanes whole = sum + term, part = whole - sum;
	const pl_lanes error = ((sum - (whole - part)) + (term - part)) + (small + *low), result = whole + error;
	*low = error - (result - whole);
	return result;
}

#if PL_OVER > 0
/* As those of lanes.h, of the one lane */
typedef int pl_lanes_truth;
PL_OWN_FUNCTION int pl_lanes_below(pl_lanes a, pl_lanes b)
{
	return a < b;
}
PL_OWN_FUNCTION int pl_lanes_equal(pl_lanes a, pl_lanes b)
{
	return a <= b && a >= b;
}
PL_OWN_FUNCTION pl_lanes pl_lanes_choose(int which, pl_lanes a, pl_lanes b)
{
	return which ? a : b;
}
#if PL_OVER > 1
PL_OWN_FUNCTION int pl_lanes_both(int a, int b)
{
	return a & b;
}
PL_OWN_FUNCTION int pl_lanes_either(int a, int b)
{
	return a | b;
}
PL_OWN_FUNCTION int pl_lanes_flags(int a)
{
	return a;
}
#endif
#define PL_LANES_UNROLL
#if PL_OVER > 1
PL_OWN_FUNCTION pl_lanes_truth PL(lanes_pass)(pl_lanes *y, const pl_lanes *factor, const real *now, int seen);
#define PL_A_STEP(y, factor, now) PL(lanes_pass)(y, factor, now, 1)
#else
PL_OWN_FUNCTION pl_lanes_truth PL(lanes_step)(pl_lanes *y, const pl_lanes *factor, const real *now);
#define PL_A_STEP(y, factor, now) PL(lanes_step)(y, factor, now)
#endif

/* A step; what it leaves of an instance that is not finite is no number from there on. */
PL_OWN_FUNCTION void PL(kernel_step)(pl_lanes *y, const pl_lanes *factor, const real *now)
{
	int i;
	if (!PL_A_STEP(y, factor, now)) {
		for (i = 0; i < PL_STATES; i++) {
			y[i] = (y[i] - y[i]) / (y[i] - y[i]);
		}
	}
}
#undef PL_A_STEP
#else
PL_OWN_FUNCTION void PL(lanes_step)(pl_lanes *y, const pl_lanes *factor, const real *now);
PL_OWN_FUNCTION void PL(kernel_step)(pl_lanes *y, const pl_lanes *factor, const real *now)
{
	PL(lanes_step)(y, factor, now);
}
#endif
PL_OWN_FUNCTION void PL(lanes_out)(const pl_lanes *y, const pl_lanes *factor, const real *now, pl_lanes *out);

#if PL_FLUSHES > 0
/* Behind every 64th step */
PL_OWN_FUNCTION void PL(kernel_flush)(real *state)
{
	PL(flushed) s;
	const int count = (int)(sizeof s / sizeof(real));
	real *const kept = (real *)&s;
	int i;
	for (i = 0; i < count; i++) {
		kept[i] = state[i];
	}
	PL(flush)(&s);
	for (i = 0; i < count; i++) {
		state[i] = kept[i];
	}
}
#endif

/* What a work item has of its instance */
typedef struct PL(item) {
	real state[PL_STEPPED], factor[PL_HAS(PL_LANES)], shared[PL_HAS(PL_SHARED)];
} PL(item);

PL_OWN_FUNCTION void PL(item_take)(PL(item) *one, PL_SIZE_TYPE j, PL_SIZE_TYPE count, PL_GLOBAL const real *y,
							   PL_GLOBAL const real *factors, PL_GLOBAL const real *now,
								   PL_GLOBAL const real *peak)
{
	int i;
	one->factor[0] = one->shared[0] = 0;
	for (i = 0; i < PL_STEPPED; i++) {
		one->state[i] = y[(PL_SIZE_TYPE)i * count + j];
	}
	for (i = 0; i < PL_LANES; i++) {
		one->factor[i] = factors[(PL_SIZE_TYPE)i * count + j];
	}
	(void)factors, (void)now, (void)peak;
}

/* Step k, by the row of what instances share in it */
PL_OWN_FUNCTION void PL(item_step)(PL(item) *one, PL_SIZE_TYPE k, PL_GLOBAL const real *now, real *out)
{
	int i;
	for (i = 0; i < PL_SHARED; i++) {
		one->shared[i] = now[i];
	}
	PL(kernel_step)(one->state, one->factor, one->shared);
#if PL_FLUSHES > 0
	if ((k & 63) == 0) {
		PL(kernel_flush)(one->state);
	}
#endif
	PL(lanes_out)(one->state, one->factor, one->shared, out);
	(void)k, (void)now;
}

PL_OWN_FUNCTION void PL(item_give)(const PL(item) *one, PL_SIZE_TYPE j, PL_SIZE_TYPE count, PL_GLOBAL real *y)
{
	int i;
	for (i = 0; i < PL_STEPPED; i++) {
		y[(PL_SIZE_TYPE)i * count + j] = one->state[i];
	}
}
#else
#include "given.h"

typedef PL_TYPE PL(item);

/* As memcpy, which devices do not have; the number is `count` bytes of a struct. */
PL_OWN_FUNCTION void PL(item_bytes)(void *to, const void *from, int count)
{
	int i;
	for (i = 0; i < count; i++) {
		((unsigned char *)to)[i] = ((const unsigned char *)from)[i];
	}
}

/* Bytes of a member from numbers of the arrays, apart by count, or back */
PL_OWN_FUNCTION void PL(item_read)(void *to, PL_GLOBAL const real *from, PL_SIZE_TYPE apart, int bytes)
{
	int i;
	for (i = 0; i < bytes; i += (int)sizeof(real)) {
		const real number = from[(PL_SIZE_TYPE)(i / (int)sizeof(real)) * apart];
		PL(item_bytes)((unsigned char *)to + i, &number, bytes - i < (int)sizeof(real)
				? bytes - i : (int)sizeof(real));
	}
}

PL_OWN_FUNCTION void PL(item_write)(const void *from, PL_GLOBAL real *to, PL_SIZE_TYPE apart, int bytes)
{
	int i;
	for (i = 0; i < bytes; i += (int)sizeof(real)) {
		real number = 0;
		PL(item_bytes)(&number, (const unsigned char *)from + i,
					   bytes - i < (int)sizeof(real) ? bytes - i : (int)sizeof(real));
		to[(PL_SIZE_TYPE)(i / (int)sizeof(real)) * apart] = number;
	}
}

/* Where row i of instance j stands */
#define PL_ROW(i) (y + (PL_SIZE_TYPE)(i)*count + j)

PL_OWN_FUNCTION void PL(item_take)(PL(item) *one, PL_SIZE_TYPE j, PL_SIZE_TYPE count, PL_GLOBAL const real *y,
							   PL_GLOBAL const real *factors, PL_GLOBAL const real *now,
								   PL_GLOBAL const real *peak)
{
	int i;
#if PL_EVENTS
	struct {
		pl_contact contact;
		int status;
	} marks;
#endif
	PL(item_read)(one, now, 1, PL_HEAD);
#if PL_OVER > 0
	PL(item_read)(one->y, PL_ROW(0), count, (int)sizeof one->y);
	PL(item_read)(one->low, PL_ROW(PL_STATES), count, (int)sizeof one->low);
#if PL_OVER > 1
	one->served = (int)*PL_ROW(2 * PL_STATES);
	PL(item_read)(one->next, PL_ROW(2 * PL_STATES + 1), count, (int)sizeof one->next);
	PL(item_read)(one->left, PL_ROW(3 * PL_STATES + 1), count, (int)sizeof one->left);
	PL(item_read)(one->series, PL_ROW(4 * PL_STATES + 1), count, (int)sizeof one->series);
#endif
	PL(item_read)(&one->status, PL_ROW(PL_STEPPED), count, (int)sizeof one->status);
#elif PL_EVENTS
	PL(item_read)(one->y, PL_ROW(0), count, (int)sizeof one->y);
	PL(item_read)(&marks, PL_ROW(PL_STEPPED), count, (int)(sizeof marks.contact + sizeof marks.status));
	PL(item_bytes)(&one->contact, &marks, (int)sizeof one->contact);
	PL(item_bytes)(&one->status, (const unsigned char *)&marks + sizeof one->contact, (int)sizeof one->status);
#else
	PL(item_read)(one, PL_ROW(0), count, PL_ROWS * (int)sizeof(real));
#endif
#if PL_LANES > 0
	for (i = 0; i < PL_LANES; i++) {
		PL(item_read)((unsigned char *)one + PL(factor_at)[i], factors + (PL_SIZE_TYPE)i * count + j, 1,
					  (int)sizeof(real));
	}
#endif
#if PL_PEAKS > 0
	for (i = 0; i < PL_PEAKS; i++) {
		one->peak[i] = peak[(PL_SIZE_TYPE)PL(peak_output)[i] * count + j];
	}
#endif
	(void)i, (void)factors, (void)now, (void)peak;
}

/* With the inputs of that step */
PL_OWN_FUNCTION void PL(item_step)(PL(item) *one, PL_SIZE_TYPE k, PL_GLOBAL const real *now, real *out)
{
#if PL_INPUTS > 0
	real u[PL_INPUTS];
	int i;
	for (i = 0; i < PL_INPUTS; i++) {
		u[i] = now[PL_SHARED - PL_INPUTS + i];
	}
#endif
	PL(step)(one PL_GIVEN);
	PL(out)(one, out);
	(void)k, (void)now;
}

PL_OWN_FUNCTION void PL(item_give)(const PL(item) *one, PL_SIZE_TYPE j, PL_SIZE_TYPE count, PL_GLOBAL real *y)
{
#if PL_OVER > 0
	PL(item_write)(one->y, PL_ROW(0), count, (int)sizeof one->y);
	PL(item_write)(one->low, PL_ROW(PL_STATES), count, (int)sizeof one->low);
#if PL_OVER > 1
	*PL_ROW(2 * PL_STATES) = (real)one->served;
	PL(item_write)(one->next, PL_ROW(2 * PL_STATES + 1), count, (int)sizeof one->next);
	PL(item_write)(one->left, PL_ROW(3 * PL_STATES + 1), count, (int)sizeof one->left);
	PL(item_write)(one->series, PL_ROW(4 * PL_STATES + 1), count, (int)sizeof one->series);
#endif
	PL(item_write)(&one->status, PL_ROW(PL_STEPPED), count, (int)sizeof one->status);
#elif PL_EVENTS
	struct {
		pl_contact contact;
		int status;
	} marks;
	PL(item_bytes)(&marks, &one->contact, (int)sizeof one->contact);
	marks.contact.crossings = 0;
	PL(item_bytes)((unsigned char *)&marks + sizeof one->contact, &one->status, (int)sizeof one->status);
	PL(item_write)(one->y, PL_ROW(0), count, (int)sizeof one->y);
	*PL_ROW(PL_STATES) = (real)one->contact.region;
	PL(item_write)(&marks, PL_ROW(PL_STEPPED), count, (int)(sizeof marks.contact + sizeof marks.status));
#else
	PL(item_write)(one, PL_ROW(0), count, PL_ROWS * (int)sizeof(real));
#endif
}
#endif

/* Sum i of output o, of instance j */
#define PL_SUM(i, o) sum[((PL_SIZE_TYPE)(i)*PL_OUTPUTS + (PL_SIZE_TYPE)(o)) * count + j]

/* n steps of instance j behind `taken` ones */
PL_OWN_FUNCTION void PL(kernel_run)(PL_SIZE_TYPE j, PL_SIZE_TYPE count, PL_SIZE_TYPE taken, PL_SIZE_TYPE n,
					PL_GLOBAL real *y, PL_GLOBAL const real *factors, PL_GLOBAL const real *now,
									PL_GLOBAL real *peak, PL_GLOBAL real *sum)
{
	real out[PL_OUTPUTS], most[PL_OUTPUTS], total[PL_OUTPUTS], squares[PL_OUTPUTS], low[PL_OUTPUTS];
	PL(item) one;
	PL_SIZE_TYPE k;
	int i;
	PL(item_take)(&one, j, count, y, factors, now, peak);
	for (i = 0; i < PL_OUTPUTS; i++) {
		most[i] = peak[(PL_SIZE_TYPE)i * count + j];
		total[i] = PL_SUM(0, i);
		squares[i] = PL_SUM(1, i);
		low[i] = PL_SUM(2, i);
		out[i] = PL_SUM(3, i);
	}
	for (k = 1; k <= n; k++) {
		PL(item_step)(&one, taken + k, now + k * PL_SHARED, out);
		for (i = 0; i < PL_OUTPUTS; i++) {
			const real size = out[i] < 0 ? -out[i] : out[i], square = out[i] * out[i];
			const real whole = squares[i] + square, part = whole - squares[i];
			most[i] = most[i] > size ? most[i] : size;
			total[i] += out[i];
			low[i] += (squares[i] - (whole - part)) + (square - part);
			squares[i] = whole;
		}
	}
	PL(item_give)(&one, j, count, y);
	for (i = 0; i < PL_OUTPUTS; i++) {
		peak[(PL_SIZE_TYPE)i * count + j] = most[i];
		PL_SUM(0, i) = total[i];
		PL_SUM(1, i) = squares[i];
		PL_SUM(2, i) = low[i];
		PL_SUM(3, i) = out[i];
	}
}

/* All of them: y and factors as in NAME_instances, now as NAME_batch_share has it.  Of ends of steps, going on from
 * what is there: peak: [outputs][count], the largest sizes; sum: [4][outputs][count], sums, sums of squares in two
 * parts, and the last values. */
PL_KERNEL PL(kernel)(PL_SIZE_TYPE count, PL_SIZE_TYPE taken, PL_SIZE_TYPE n, PL_GLOBAL real *y,
					 PL_GLOBAL const real *factors, PL_GLOBAL const real *now, PL_GLOBAL real *peak,
					 PL_GLOBAL real *sum)
{
#if PL_OPENCL
	const PL_SIZE_TYPE j = get_global_id(0);
	if (j < count) {
		PL(kernel_run)(j, count, taken, n, y, factors, now, peak, sum);
	}
#elif PL_CUDA
	const PL_SIZE_TYPE j = (PL_SIZE_TYPE)blockIdx.x * blockDim.x + threadIdx.x;
	if (j < count) {
		PL(kernel_run)(j, count, taken, n, y, factors, now, peak, sum);
	}
#else
	PL_SIZE_TYPE j;
#pragma omp target teams distribute parallel for \
	map(tofrom : y[:PL_ROWS * count], peak[:PL_OUTPUTS * count], sum[:4 * PL_OUTPUTS * count]) \
	map(to : factors[:PL_LANES * count], now[:(n + 1) * PL_SHARED])
	for (j = 0; j < count; j++) {
		PL(kernel_run)(j, count, taken, n, y, factors, now, peak, sum);
	}
#endif
}

#if PL_CUDA
/* The same from the host, on memory of the device: by blocks of 128 instances */
extern "C" int PL(launch)(PL_SIZE_TYPE count, PL_SIZE_TYPE taken, PL_SIZE_TYPE n, real *y, const real *factors,
						  const real *now, real *peak, real *sum)
{
	PL(kernel)<<<(unsigned)((count + 127) / 128), 128>>>(count, taken, n, y, factors, now, peak, sum);
	return (int)cudaGetLastError();
}
#endif

#include "undef.h"
