/* SPDX-License-Identifier: MIT-0 */
/* kernel.h: NAME_kernel, many steps of many instances on a device, for OpenCL, CUDA and OpenMP: each work item steps
 * one instance of NAME_batch, with the sums of its lanes.  Loads and samples, which instances share, come from
 * NAME_batch_share on the host.  Included by the file of the kernel, which defines before it
 *
 *     PL_OPENCL, PL_CUDA         1: for that; else for OpenMP
 *     PL_STEPPED, PL_OUTPUTS     numbers of an instance that a step changes, outputs
 *     PL_SHARED, PL_LANES        numbers of a step that instances share; that params decide, of an instance
 *     PL_OVER, PL_STATES         steps of a series of fixed order, series_lanes.h, and states; 0: a linear step
 *     PL_FLUSHES                 above 0: decayed states become 0, by PL(flush) on PL(flushed) of flush.h
 *     pl_lanes                   a number, of which there is one in each work item
 *
 * and behind it PL(lanes_step), or PL(lanes_pass), and PL(lanes_out), as batch.h has them. */
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

/* Sum i of output o, of instance j */
#define PL_SUM(i, o) sum[((PL_SIZE_TYPE)(i)*PL_OUTPUTS + (PL_SIZE_TYPE)(o)) * count + j]

/* n steps of instance j behind `taken` ones */
PL_OWN_FUNCTION void PL(kernel_run)(PL_SIZE_TYPE j, PL_SIZE_TYPE count, PL_SIZE_TYPE taken, PL_SIZE_TYPE n,
                                    PL_GLOBAL real *y, PL_GLOBAL const real *factors, PL_GLOBAL const real *now,
                                    PL_GLOBAL real *peak, PL_GLOBAL real *sum)
{
    real state[PL_STEPPED], factor[PL_HAS(PL_LANES)], shared[PL_HAS(PL_SHARED)], out[PL_OUTPUTS];
    real most[PL_OUTPUTS], total[PL_OUTPUTS], squares[PL_OUTPUTS], low[PL_OUTPUTS];
    PL_SIZE_TYPE k;
    int i;
    factor[0] = shared[0] = 0;
    for (i = 0; i < PL_STEPPED; i++) {
        state[i] = y[(PL_SIZE_TYPE)i * count + j];
    }
    for (i = 0; i < PL_LANES; i++) {
        factor[i] = factors[(PL_SIZE_TYPE)i * count + j];
    }
    for (i = 0; i < PL_OUTPUTS; i++) {
        most[i] = peak[(PL_SIZE_TYPE)i * count + j];
        total[i] = PL_SUM(0, i);
        squares[i] = PL_SUM(1, i);
        low[i] = PL_SUM(2, i);
        out[i] = PL_SUM(3, i);
    }
    for (k = 1; k <= n; k++) {
        for (i = 0; i < PL_SHARED; i++) {
            shared[i] = now[k * PL_SHARED + (PL_SIZE_TYPE)i];
        }
        PL(kernel_step)(state, factor, shared);
#if PL_FLUSHES > 0
        if (((taken + k) & 63) == 0) {
            PL(kernel_flush)(state);
        }
#endif
        PL(lanes_out)(state, factor, shared, out);
        for (i = 0; i < PL_OUTPUTS; i++) {
            const real size = out[i] < 0 ? -out[i] : out[i], square = out[i] * out[i];
            const real whole = squares[i] + square, part = whole - squares[i];
            most[i] = most[i] > size ? most[i] : size;
            total[i] += out[i];
            low[i] += (squares[i] - (whole - part)) + (square - part);
            squares[i] = whole;
        }
    }
    for (i = 0; i < PL_STEPPED; i++) {
        y[(PL_SIZE_TYPE)i * count + j] = state[i];
    }
    for (i = 0; i < PL_OUTPUTS; i++) {
        peak[(PL_SIZE_TYPE)i * count + j] = most[i];
        PL_SUM(0, i) = total[i];
        PL_SUM(1, i) = squares[i];
        PL_SUM(2, i) = low[i];
        PL_SUM(3, i) = out[i];
    }
    (void)factors;
    (void)now;
    (void)taken;
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
    map(tofrom : y[:PL_STEPPED * count], peak[:PL_OUTPUTS * count], sum[:4 * PL_OUTPUTS * count]) \
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
