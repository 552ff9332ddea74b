#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# NAME_batch of some models against NAME_step of each instance alone (batch.c): the same bits. And which models have
# instances that each step by themselves.
#
#     batch.sh PLGEN SOURCE_ROOT
#
# MERGE=1: of all of these models. LONG=1: of more, as vectors of what this machine has too, and by clang; there
# products may be contracted. Else code that another test compiles with an optimiser has none: its bits are the same.
root=$2
. "${0%/*}/../plgen.sh"
here=$root/tests/batch
specs=$root
warnings='-Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wdouble-promotion -Werror'
level=-O0
[ -z "${LONG:-}" ] || level=-O1

# agrees UNITS COMPILER FLAGS SPEC OPTION ...: of one model, built so
agrees() {
	units=$1
	compiler=$2
	flags=$3
	spec=$4
	shift 4
	chosen "$spec $* $compiler $flags" || return 0
	what="-DHAS_INPUTS=1"
	{
		"$plgen" --batch --prefix m "$@" -o m.c "$(root=$specs path_of "$spec")" &&
			{ ! grep -q 'M_INPUTS = 0' m.h || what=-DHAS_INPUTS=0; } &&
			{ ! grep -q M_BATCH_FACTORS m.h || what="$what -DTUNED"; } &&
			{ ! grep -q '^#define PL_FLOAT_ONLY' m.h || what="$what -DREAL_FLOAT"; } &&
			$compiler $flags $warnings -I"$root/runtime" -c m.c -o m.o &&
			$compiler $flags $what -I"$root/runtime" -I. "$here/batch.c" m.o "$archive" -lm -o m &&
			./m "$units"
	} >log 2>&1
	result $? "$spec${*:+ $*}, $compiler $flags"
}

# by_itself SPEC WHY: so its header says, and its bits are the same
by_itself() {
	if [ -n "${LONG:-}" ]; then
		agrees 0 "${CC:-cc}" -O0 "$1"
	else
		agrees 0 "$run_cc" '' "$1"
	fi
	grep -q " \* Each takes its steps by itself: $2\." m.h
	result $? "$1, each by itself: $2"
	kernel "$1"
}

# Events one by one, other steps in lanes: under inputs that are held and that ramp, with a load, friction, a stop
printf '%s\n' 'model stops' 'param w = 0.5, g = 0.1, k = 40' 'tunable g, w' 'input p hold first, q' 'coord x, y' \
	'init x = 0.3, y = -0.2' \
	"x'' + 0.2*x' + deadzone(x - 0.1*p, -w, 0.4)*k + 3*(x - y) = q + 0.3*cos(5*t)" \
	"y'' + 0.1*y' + 3*(y - x) + 9*y = p - g" 'output x, y' "output a = x'', g" 'step 0.02' >"$work/stops.spec"
printf '%s\n' 'model rubs' 'input p hold first, q' 'coord x' 'init x = 0.3' \
	"x'' + 30*x + friction(x', 0.6, 0.8) = q + p" 'stop between x, ground at 0.5 restitution 0.4' \
	'step 0.02' >"$work/rubs.spec"
# Series of fixed order: of a step, of several; with samples, loads, functions, params of each instance
printf '%s\n' 'model swings' 'param w = 1, f = 0.4' 'tunable w, f' 'input p hold first, q' 'coord x' 'init x = 1' \
	"x'' + 0.1*x' + w^2*sin(x) + 0.2*x*(1 + x^2)^0.3 = f*cos(0.9*t) + p + 0.1*t*q" "output x, x'" \
	"output e = w*x'^2 + cos(x)" 'scheme taylor 5' 'step 0.1' >"$work/swings.spec"
sed -e '/^input/d' -e 's/ + p + .*/ + log(2 + x)/' -e 's/taylor 5/taylor 6 over 3/' "$work/swings.spec" \
	>"$work/several.spec"

# More than 16 states: oscillators alike, of params of each instance, and one that is not; modes of a chain
awk 'BEGIN {
	print "model blocks\nparam z = 0.1, f = 1\ntunable z, f\ninput p hold first, q"
	for (i = 1; i < 10; i++)
		printf "coord x%d\n x%d\047\047 + z*x%d\047 + %d*x%d = f*p + q\n", i, i, i, i, i
	print "coord v\nv\047\047 + 3*v = z*p\noutput x1, x9\047, v, s = 2*x3 + z*x4\047 + f*q\nstep 0.05"
}' >"$work/blocks.spec"
awk 'BEGIN {
	print "model modes\ninput p hold first, q\ncoord x0, x1, x2, x3, x4, x5, x6, x7, x8, x9, x10"
	for (i = 1; i < 10; i++)
		printf "x%d\047\047 + 0.02*(2*x%d\047 - x%d\047 - x%d\047) + 40*(2*x%d - x%d - x%d) = %s\n", i, i,
			i - 1, i + 1, i, i - 1, i + 1, i % 3 ? "q" : "p + cos(3*t)"
	print "x0\047 = -x0\nx10\047 = -2*x10\ninit x4 = 1\noutput x1, x9\nstep 0.05"
}' >"$work/modes.spec"

while read -r spec options; do
	[ -n "$spec" ] || continue
	case $spec in
		# Extremes are found from the same numbers, A of the spec's in one of them, with another peak to pass.
		*peaks* | */free.spec | */loaded.spec | */record.spec) bits=300 ;;
		*) bits=0 ;;
	esac
	# shellcheck disable=SC2086
	long || { ! one_of 3 || agrees $bits "$run_cc" '' "$spec" $options; continue; }
	agrees $bits "${CC:-cc} -std=c99" -O0 "$spec" $options
	for compiler in "${CC:-cc} -std=c99" 'clang -std=c99'; do
		# shellcheck disable=SC2086
		agrees 300 "$compiler" '-O2 -march=native' "$spec" $options
		# shellcheck disable=SC2086
		agrees $bits "$compiler" '-O2 -ffp-contract=off' "$spec" $options
	done
done <<END
models/oscillator.spec
models/sdcsf.spec --form delta --accuracy compensated --real float
tests/forms/masses.spec
tests/batch/forced.spec --anchors 1
tests/peaks/tuned.spec
tests/batch/free.spec
tests/batch/loaded.spec --anchors 1
tests/batch/record.spec
tests/refresh/fast.spec --anchors 1
models/gear1.spec
models/stick_slip.spec --tunable F
${LONG:+models/two_masses.spec
models/impact_oscillator.spec
tests/relative/drive.spec
models/oscillator.spec --real float
models/sdcsf.spec --form delta --accuracy compensated --anchors 1
tests/tunable/sensor.spec
tests/tunable/pair.spec --form direct
tests/tunable/cart.spec --real float
tests/forms/damped_ramped.spec
tests/relative/train.spec
models/quarter_car.spec --real float
models/scs.spec --accuracy compensated
models/tuned_floor.spec --anchors 1
tests/peaks/peaks.spec
tests/holds/tuned.spec}
END

agrees 0 "${CC:-cc} -std=c99" "$level -ffp-contract=off" tests/batch/phased.spec --real float
for spec in stops.spec rubs.spec swings.spec several.spec blocks.spec modes.spec; do
	if ! merging; then
		case $spec in rubs* | modes*) continue ;; esac     # gcc takes five seconds of the one
	else
		specs=$work agrees 0 "$run_cc" '' "$spec"
		[ $spec = swings.spec ] ||
			specs=$work agrees 0 "${CC:-cc} -std=c99" "$level -ffp-contract=off" "$spec"
	fi
	specs=$work agrees 0 "${CC:-cc} -std=c99" "$level -march=native -ffp-contract=off" "$spec"
	! grep -q 'by itself:' m.h
	result $? "$spec: its steps without events are in lanes"
done

# A model written by hand, x'' + x = 0 with a sixth of a turn a step: peaks.h and batch.h without a generator. After six
# steps each instance is where it was, and its largest |x| is the amplitude, between steps.
cat >hand.c <<'END'
#include "plrt.h"

#define PL(name) m_##name
#include "lanes.h"

#include <math.h>
#include <stdio.h>

typedef struct m { double y[2], t, peak[1]; } m;
typedef struct m_instances { size_t count; double *y, *peak; m shared; } m_instances;
static const double m_h = 1.0471975511965976, m_cos = 0.5, m_sin = 0.8660254037844386;
static const double m_slope[2][2] = {{0, 1}, {-1, 0}}, m_row[1][2] = {{1, 0}};
static const double m_bend[1][2] = {{0.1371, 0.1371}};         /* h^2/8, and |x''| <= |x| + |x'| */
static const int m_peak_output[1] = {1};

static void m_set(m *s, double t, const double y[2]) { *s = (m){{y[0], y[1]}, t, {0}}; }
static void m_init(m *s) { m_set(s, 0, (const double[]){1, 0}); }
static void m_get(const m *s, double y[2]) { y[0] = s->y[0]; y[1] = s->y[1]; }
static double m_time(const m *s) { return s->t; }
static int m_status(const m *s) { return pl_not_finite(s->y, 2); }

#define PL(name) m_##name
#define PL_TYPE m
#define PL_STATES 2
#define PL_OUTPUTS 2
#define PL_SIZE 2
#define PL_PEAKS 1
#define PL_H m_h
#define PL_SLOPE m_slope
#define PL_BEND m_bend
#define PL_PEAK_ROW(c, p) m_row[p]
#include "peaks.h"

static void m_begin_step(const m *s, const double *u, double x[2]) { m_get(s, x); (void)u; }
static void m_now(const m *s, double out[2]) { out[0] = s->y[1]; out[1] = s->y[0]; }
static void m_one_step(m *s)
{
	const double x = s->y[0], v = s->y[1];
	s->y[0] = m_cos * x + m_sin * v;
	s->y[1] = m_cos * v - m_sin * x;
	s->t += m_h;
}
static void m_share_step(m *s, const double *u, double *now) { s->t += m_h; (void)u; (void)now; }
static void m_share_out(const m *s, double *now) { (void)s; (void)now; }
PL_LANES_INLINE void m_lanes_step(pl_lanes *y, const pl_lanes *factor, const double *now)
{
	const pl_lanes x = y[0], v = y[1];
	y[0] = m_cos * x + m_sin * v;
	y[1] = m_cos * v - m_sin * x;
	(void)factor;
	(void)now;
}
PL_LANES_INLINE void m_lanes_out(const pl_lanes *y, const pl_lanes *factor, const double *now, pl_lanes *out)
{
	out[0] = y[1];
	out[1] = y[0];
	(void)factor;
	(void)now;
}
PL_LANES_INLINE void m_lanes_bend(const pl_lanes *state, const pl_lanes *factor, const double *reach, pl_lanes *bend)
{
	bend[0] = 0.1371 * (pl_lanes_peak(pl_lanes_all(0), state[0]) + pl_lanes_peak(pl_lanes_all(0), state[1]));
	(void)factor;
	(void)reach;
}

#define PL(name) m_##name
#define PL_TYPE m
#define PL_INSTANCES m_instances
#define PL_STATES 2
#define PL_OUTPUTS 2
#define PL_ROWS 2
#define PL_STEPPED 2
#define PL_GROUPS 4
#define PL_SHARED 0
#define PL_FACTORS 0
#define PL_LANES 0
#define PL_PEAKS 1
#define PL_SIZE 2
#define PL_NOMINAL m_bend
#include "batch.h"

static double worst;
static void compare(double value, double truth) { worst = fmax(worst, fabs(value - truth)); }

static void judge(size_t count, int outputs)
{
	static double y[2 * 70], peak[2 * 70], out[6 * 2 * 70];
	m_instances b = {count, y, peak, {{0, 0}, 0, {0}}};
	size_t j;
	int i;
	m_batch_init(&b);
	for (j = 0; j < count; j++)
		m_batch_set(&b, j, (const double[]){cos((double)j), 0.01 * (double)j});
	for (i = 0; i < 50; i++)
		m_batch(&b, 6, outputs ? out : NULL);
	for (j = 0; j < count; j++) {
		const double start[2] = {cos((double)j), 0.01 * (double)j}, amplitude = hypot(start[0], start[1]);
		double now[2];
		m alone;
		m_set(&alone, 0, start);
		for (i = 0; i < 6; i++)
			m_step(&alone);
		m_out(&alone, now);
		compare(now[1], amplitude);
		m_batch_get(&b, j, now);
		compare(now[0], start[0]);
		compare(now[1], start[1]);
		compare(peak[count + j], amplitude);
		if (outputs)
			compare(out[11 * count + j], amplitude);
	}
	compare(m_time(&b.shared), 300 * m_h);
}

/* In each lane: what is not a number stays none in peaks, and is above all */
static int lanes_report(void)
{
	enum { LANES = sizeof(pl_lanes) / sizeof(double) };
	const pl_lanes two = pl_lanes_all(2), three = pl_lanes_all(3), below = pl_lanes_all(-3);
	int good = isnan(pl_larger_size(1, NAN)) && fabs(pl_larger_size(1, -2)) > 1.5 && pl_larger_size(1, -0.5) > 0.9;
	size_t j, k;
	good = good && !pl_lanes_above(below, below) && pl_lanes_above(two, below) && !pl_lanes_above(two, three);
	for (j = 0; j < LANES; j++) {
		double x[LANES], most[LANES];
		for (k = 0; k < LANES; k++)
			x[k] = k == j ? NAN : -3;
		pl_lanes_store(most, pl_lanes_peak(two, pl_lanes_load(x, LANES)), LANES);
		for (k = 0; k < LANES; k++)
			good = good && (k == j ? isnan(most[k]) : fabs(most[k] - 3) <= 0);
		good = good && pl_lanes_above(pl_lanes_load(x, LANES), three);
		good = good && pl_lanes_above(two, pl_lanes_load(x, LANES));
		x[j] = 2.5;
		good = good && pl_lanes_above(pl_lanes_load(x, LANES), two);
		good = good && !pl_lanes_above(pl_lanes_load(x, LANES), three);
	}
	return good;
}

int main(void)
{
	size_t count;
	m first;
	m_init(&first);
	for (count = 1; count <= 70; count += 23) {
		judge(count, 0);
		judge(count, 1);
	}
	printf("# worst %.3g\n", worst);
	return !(worst < 1e-12 && m_status(&first) == 0 && lanes_report());
}
END
for compiler in "${CC:-cc} -std=c99 -O0 $warnings" "$run_cc" "${CC:-cc} -std=c99 -O2 $warnings"; do
	merging || [ "${compiler#*-O2}" = "$compiler" ] || continue
	{
		$compiler -I"$root/runtime" hand.c "$archive" -lm -o hand && ./hand
	} >log 2>&1
	result $? "a model written by hand, ${compiler%% -W*}"
done

# ---- kernels: by the compiler for OpenMP, and by OpenCL where there is a device, against NAME_batch ----

cat >kernel.c <<'END'
/* Bits of states, peaks and sums of a kernel against those of NAME_batch */
#include "m.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#ifdef REAL_FLOAT
typedef float real;
#else
typedef double real;
#endif
enum { COUNT = 37, ROWS = 90, FIRST = 50, SMALL = 5 };
enum { INPUTS = M_INPUTS ? M_INPUTS : 1, SHARED = M_BATCH_SHARED ? M_BATCH_SHARED : 1 };
void m_kernel(unsigned long long count, unsigned long long taken, unsigned long long n, real *y, const real *factors,
			  const real *now, real *peak, real *sum);
static real y[2][M_BATCH_ROWS * COUNT], peak[2][M_OUTPUTS * COUNT], sum[2][4][M_OUTPUTS * COUNT];
static real out[ROWS * M_OUTPUTS * COUNT], now[(ROWS + 1) * SHARED], u[ROWS * INPUTS];
#ifdef M_BATCH_FACTORED
static real factors[M_BATCH_FACTORS * COUNT];
#else
static real factors[1];
#endif

/* How many numbers are others; what is none has any sign */
static int apart_in(const real *a, const real *b, int count)
{
	int i, apart = 0;
	for (i = 0; i < count; i++)
		apart += memcmp(&a[i], &b[i], sizeof *a) != 0 && !(isnan(a[i]) && isnan(b[i]));
	return apart;
}

/* Instance j in both: states, status, events */
static int apart_instances(const m_instances *b, const m_instances *of_device, size_t j)
{
	real states[2][M_STATES];
	int apart = m_batch_status(b, j) != m_batch_status(of_device, j);
	m_batch_get(b, j, states[0]);
	m_batch_get(of_device, j, states[1]);
#ifdef CROSSED
	{
		m s[2];
		m_batch_take(b, j, &s[0]);
		m_batch_take(of_device, j, &s[1]);
		apart += m_crossed(&s[0]) != m_crossed(&s[1]);
	}
#endif
	return apart + apart_in(states[0], states[1], M_STATES);
}

int main(void)
{
	m_instances b = {0}, of_device;
	int i, j, k, apart = 0;
	b.count = COUNT;
	b.y = y[0];
	b.peak = peak[0];
#ifdef M_BATCH_FACTORED
	b.factors = factors;
#endif
	m_batch_init(&b);
	for (j = 0; j < COUNT; j++) {
		real state[M_STATES];
		for (i = 0; i < M_STATES; i++) /* one of them all but decayed */
			state[i] = (real)(cos(3.0 * i + j) * (j != SMALL ? 1 : sizeof(real) == 4 ? 1e-37 : 1e-291));
#ifdef M_BATCH_FACTORED
		{
			static m_coeffs c;
			real params[M_PARAMS];
			c = m_nominal;
			for (i = 0; i < M_PARAMS; i++)
				params[i] = m_nominal.params[i] * (real)(1.0 + 0.01 * j);
			if (m_retune(&c, params, (real)M_H) != 0 || m_batch_use(&b, (size_t)j, &c) != 0)
				return 2;
		}
#endif
		m_batch_set(&b, (size_t)j, state);
	}
	for (i = 0; i < ROWS * INPUTS; i++)
		u[i] = (real)sin(0.3 * i);
	memcpy(y[1], y[0], sizeof y[0]);
	memcpy(peak[1], peak[0], sizeof peak[0]);
	of_device = b;
#if HAS_INPUTS
	m_batch_share(&of_device, ROWS, u, now);
	m_batch(&b, ROWS, u, out);
#else
	m_batch_share(&of_device, ROWS, now);
	m_batch(&b, ROWS, out);
#endif
	m_kernel(COUNT, 0, FIRST, y[1], factors, now, peak[1], sum[1][0]);
	m_kernel(COUNT, FIRST, ROWS - FIRST, y[1], factors, now + FIRST * M_BATCH_SHARED, peak[1], sum[1][0]);
	for (k = 0; k < ROWS; k++)
		for (i = 0; i < M_OUTPUTS * COUNT; i++) {
			const real last = out[k * M_OUTPUTS * COUNT + i], square = last * last, before = sum[0][1][i];
			const real whole = before + square, part = whole - before;
			sum[0][0][i] += last;
			sum[0][1][i] = whole;
			sum[0][2][i] += (before - (whole - part)) + (square - part);
			sum[0][3][i] = last;
		}
	of_device.y = y[1];
	for (j = 0; j < COUNT; j++)
		apart += apart_instances(&b, &of_device, (size_t)j);
	apart += apart_in(peak[0], peak[1], M_OUTPUTS * COUNT) + apart_in(sum[0][0], sum[1][0], 4 * M_OUTPUTS * COUNT);
	apart += m_time(&b.shared) < m_time(&of_device.shared) || m_time(&b.shared) > m_time(&of_device.shared);
	printf("# state 0 of instance 1: %.17g by the kernel, %.17g in the batch\n", (double)y[1][1], (double)y[0][1]);
	return apart != 0;
}
END
echo 'int main(void) { return 0; }' >linked.c
openmp=-fopenmp
${CC:-cc} $openmp linked.c -o linked 2>/dev/null || openmp=
cat >cl.c <<'END'
/* m_kernel by the first device of OpenCL; without one the status 2 */
#define CL_TARGET_OPENCL_VERSION 120
#include "m.h"
#include <CL/cl.h>
#include <stdio.h>
#include <stdlib.h>

#ifdef REAL_FLOAT
typedef float real;
#else
typedef double real;
#endif
#ifdef M_BATCH_FACTORED
#define FACTORS M_BATCH_FACTORS *c
#else
#define FACTORS 1
#endif
void m_kernel(unsigned long long count, unsigned long long taken, unsigned long long n, real *y, const real *factors,
			  const real *now, real *peak, real *sum)
{
	static char source[1 << 20];
	const char *text = source;
	const size_t c = (size_t)count, each = M_OUTPUTS * c, size[] = {M_BATCH_ROWS * c,
		FACTORS, (size_t)(n + 1) * (M_BATCH_SHARED ? M_BATCH_SHARED : 1), each, 4 * each};
	const void *from[] = {y, factors, now, peak, sum};
	real *const to[] = {y, NULL, NULL, peak, sum};
	const cl_ulong number[] = {count, taken, n};
	cl_platform_id platform;
	cl_device_id id;
	cl_mem memory[5];
	int i;
	FILE *f = fopen("m.cl", "r");
	if (!f || fread(source, 1, sizeof source - 1, f) == 0 || clGetPlatformIDs(1, &platform, NULL) != CL_SUCCESS ||
		clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &id, NULL) != CL_SUCCESS)
		exit(2);
	cl_context context = clCreateContext(NULL, 1, &id, NULL, NULL, NULL);
	cl_command_queue queue = clCreateCommandQueue(context, id, 0, NULL);
	cl_program program = clCreateProgramWithSource(context, 1, &text, NULL, NULL);
	if (clBuildProgram(program, 1, &id, "", NULL, NULL) != CL_SUCCESS)
		exit(3);
	cl_kernel kernel = clCreateKernel(program, "m_kernel", NULL);
	for (i = 0; i < 8; i++)
		if (i < 3)
			clSetKernelArg(kernel, (cl_uint)i, sizeof(cl_ulong), &number[i]);
		else {
			memory[i - 3] = clCreateBuffer(context, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR,
				size[i - 3] * sizeof(real), (void *)from[i - 3], NULL);
			clSetKernelArg(kernel, (cl_uint)i, sizeof(cl_mem), &memory[i - 3]);
		}
	clEnqueueNDRangeKernel(queue, kernel, 1, NULL, &c, NULL, 0, NULL, NULL);
	for (i = 0; i < 5; i++)
		if (to[i])
			clEnqueueReadBuffer(queue, memory[i], CL_TRUE, 0, size[i] * sizeof(real), to[i], 0, NULL, NULL);
}
END
opencl=
! ${CC:-cc} -include CL/cl.h -DCL_TARGET_OPENCL_VERSION=120 linked.c -lOpenCL -o linked 2>/dev/null || opencl=cl.c
# kernel SPEC OPTION ...: that of OpenMP, and where there is a device that of OpenCL
kernel() {
	spec=$1
	shift
	one_of 3 || return 0
	chosen "kernel of $spec $*" || return 0
	what="-DHAS_INPUTS=1"
	case "$*" in *float*) own= ;; *) own='--math own' ;; esac
	{
		"$plgen" --batch $own --prefix m "$@" -o m.c "$(root=$specs path_of "$spec")" &&
			"$plgen" --target openmp --prefix m "$@" "$(root=$specs path_of "$spec")" >m_kernel.c &&
			{ ! grep -q 'M_INPUTS = 0' m.h || what=-DHAS_INPUTS=0; } &&
			{ ! grep -q M_BATCH_FACTORS m.h || what="$what -DM_BATCH_FACTORED"; } &&
			{ ! { grep -q m_crossed m.h && grep -q m_batch_take m.h; } || what="$what -DCROSSED"; } &&
			{ ! grep -q '^#define PL_FLOAT_ONLY' m.h || what="$what -DREAL_FLOAT"; } &&
			${CC:-cc} -std=c99 $level -ffp-contract=off $openmp $warnings -Wno-unknown-pragmas \
				-c m_kernel.c &&
			${CC:-cc} -std=c99 $level -ffp-contract=off $what -I"$root/runtime" -c kernel.c m.c &&
			${CC:-cc} kernel.o m.o m_kernel.o "$archive" -lm $openmp -o kernel && ./kernel
	} >log 2>&1
	result $? "kernel of $spec${*:+ $*}: the bits of the batch"
	# a second for each
	case $spec in *oscillator* | blocks* | cubes3* | *stick_slip*) ;; *) merging || return 0 ;; esac
	name="... by OpenCL"
	{
		"$plgen" --target opencl --prefix m "$@" "$(root=$specs path_of "$spec")" >m.cl &&
			${CC:-cc} -std=c99 $level $what -I"$root/runtime" -I. kernel.o ${opencl:-linked.c} m.o \
				"$archive" -lOpenCL -lm -o kernel && POCL_CACHE_DIR=$PWD XDG_CACHE_HOME=$PWD ./kernel
	} >log 2>&1
	status=$?
	if [ -z "$opencl" ] || [ $status -eq 2 ]; then
		skip "$name" 'OpenCL: ocl-icd-opencl-dev, pocl-opencl-icd'
	else
		result $status "$name"
	fi
}
kernel models/oscillator.spec
kernel models/sdcsf.spec --form delta --accuracy compensated --real float
kernel tests/batch/forced.spec
specs=$work kernel blocks.spec
specs=$work kernel modes.spec
# Series without functions: of a step with samples, of several with a load
sed -e 's/ + w.2\*sin(x).*)^0.3/ + w^2*x + 0.2*x^3/' -e "s/^output e .*/output e = 2*x'/" "$work/swings.spec" \
	>"$work/cubes.spec"
sed -e '/^input/d' -e 's/ + p + .*//' -e 's/taylor 5/taylor 6 over 3/' "$work/cubes.spec" >"$work/cubes3.spec"
specs=$work kernel cubes.spec
specs=$work kernel cubes3.spec
# Whole steps: events, friction, impacts, functions, peaks inside steps
kernel models/stick_slip.spec
kernel models/gear1.spec
kernel tests/peaks/tuned.spec
for spec in stops rubs swings several; do specs=$work kernel $spec.spec; done
"$plgen" --target cuda --real float "$work/swings.spec" >kernel.cu 2>log
status=$?
grep -q 'error: --target cuda: functions in float have other bits on a device' log && [ $status -eq 1 ] &&
	[ ! -s kernel.cu ]
result $? 'no kernel of functions in float'
name='doc/device.c, by OpenCL: the bits of the batch'
if [ -z "$opencl" ]; then
	skip "$name" 'there is no OpenCL to link with: ocl-icd-opencl-dev'
else
	"$plgen" --batch -o oscillator_pl.c "$root/models/oscillator.spec" &&
		"$plgen" --target opencl -o oscillator_pl.cl "$root/models/oscillator.spec" &&
		${CC:-cc} -std=c99 $level -ffp-contract=off -I"$root/runtime" -I. "$root/doc/device.c" oscillator_pl.c \
			"$archive" -lOpenCL -lm -o device && POCL_CACHE_DIR=$PWD XDG_CACHE_HOME=$PWD ./device >log 2>&1
	status=$?
	if [ $status -eq 2 ]; then
		skip "$name" 'OpenCL finds no device: pocl-opencl-icd'
	else
		result $status "$name"
	fi
fi

# tcc adds one number at a time: groups of lanes that instances do not fill are those of others
[ -n "${LONG:-}" ] || agrees 0 "${CC:-cc} -std=c99" -O0 models/oscillator.spec

why='no numbers of its region alone show a step to be free of events'
sed -e 's/^tunable g, w/&, k/' -e '/^output a/d' "$work/stops.spec" >"$work/tuned_stops.spec"
specs=$work by_itself tuned_stops.spec "$why"
by_itself models/pendulum.spec 'the remainder is not linear in the state'
sed -n '/^=== cart_stops$/,/^---$/{/^[=-]/!p;}' "$root/tests/mechanisms/mechanisms.cases" >cart_stops.spec
specs=$work by_itself cart_stops.spec 'each looks by itself how far its series holds'
by_itself models/slider_crank.spec 'each looks by itself how far its series holds'
by_itself models/vanderpol_stiff.spec 'the remainder is not linear in the state'
by_itself tests/tunable/changes.spec 'loads change their formula inside a step'
by_itself tests/tunable/sweep.spec 'its loads may have a frequency of its own'
by_itself tests/relative/row.spec 'a block of more than 16 states is summed over its rows, in vectors of its own'
by_itself tests/forms/carried.spec 'its states are kept as differences'
sed 's/0.2\*u)/0.2*held)/' "$root/tests/peaks/peaks.spec" >"$work/jumps.spec"
specs=$work by_itself jumps.spec 'output pa is the peak of what jumps with the samples'
# Samples of delayed inputs around whole steps, held and ramps
printf '%s\n' 'model late' 'coord x' 'input p, q' 'init x = 0.3' \
	"x'' + 30*x + friction(x', 0.6, 0.8) = q + p(t - 0.053)" \
	'stop between x, ground at 0.5 restitution 0.4' 'step 0.02' >"$work/late.spec"
sed 's/^input.*/& hold first/' "$work/late.spec" >"$work/late_ramp.spec"
specs=$work kernel late.spec
specs=$work kernel late_ramp.spec
tap_end
