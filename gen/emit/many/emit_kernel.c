/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NAME_kernel: the step and the outputs of lanes, of which a work item of a device has one, and kernel.h. */
#include "inner.h"

#include <string.h>

static const char *const words_of_opencl =
	"#pragma OPENCL FP_CONTRACT OFF\n"
	"#  define PL_LANES_INLINE static\n";
static const char *const words_of_cuda = "#  define PL_LANES_INLINE static __device__ inline\n";
static const char *const words_of_openmp = "#  define PL_LANES_INLINE static inline\n";

/* What stands against a kernel: some instances of a batch would each step by themselves. */
static void check_kernel(const struct emitter *e, const char *target)
{
	const char *why = step_objection(e->step, CAN_KERNEL);
	if (!why)
		why = e->step->no.lanes;
	if (why)
		error(e->model->spec->name_at, "--batch steps any model", "--target %s: %s", target, why);
}

/* NAME_flush, on what an instance keeps of its states */
static void emit_kernel_flush(const struct emitter *e, const char *function, const char *bits)
{
	const char *low = e->step->program->compensated ? format(", low[%d]", e->system->states) : "";
	if (!e->step->linear.flush)
		return;
	say(e, "typedef struct $n_flushed { double y[%d]%s; } $n_flushed;\n", e->system->states, low);
	begin_flush(e);
	say_macro(e, "TYPE", spell(e, "$n_flushed"));
	say_macro(e, "APART", "");
	say_macro(e, "FLUSH_FUNCTION", function);
	say_macro(e, "FLUSH_BITS", bits);
	say(e, "#include \"flush.h\"\n");
}

void emit_kernel(const struct emitter *e, const char *target)
{
	const bool opencl = strcmp(target, "opencl") == 0, cuda = strcmp(target, "cuda") == 0;
	const bool openmp = !opencl && !cuda;
	check_kernel(e, target);
	struct emitter on_device = *e;
	on_device.device = opencl ? "__constant" : cuda ? "static __device__ const" : "static const";
	struct batch b = plan_batch(&on_device);
	if (has_series(e) && (b.out_alone || calls_functions(b.step) || calls_functions(b.out)))
		error(e->model->spec->name_at, "--batch steps any model", "--target %s: functions and outputs that are "
		      "not linear have other bits on a device", target);
	say(e, "\n"
	       "/* For %s: a work item steps one instance. The host is the C of plgen --batch: it has the arrays, and\n"
	       " * what all share comes from $n_batch_share. Bits are those of $n_batch where products are not\n"
	       " * contracted%s. */\n"
	       "%s%s#  define pl_lanes_all(value) (value)\n"
	       "typedef double pl_lanes;\n",
	    opencl ? "OpenCL" : cuda ? "CUDA" : "OpenMP", cuda ? " (nvcc -fmad=false)" : "",
	    opencl && !e->model->request.single ? "#pragma OPENCL EXTENSION cl_khr_fp64 : enable\n" : "",
	    opencl ? words_of_opencl : cuda ? words_of_cuda : words_of_openmp);
	say(e, "%s", openmp ? "#pragma omp declare target\n" : "");
	emit_kernel_flush(&on_device, cuda ? "__device__" : "", e->model->request.single ? "unsigned"
			  : opencl ? "ulong" : "unsigned long long");
	say(e, "%s", openmp ? "#pragma omp end declare target\n" : "");
	emit_sizes(e, "kernel.h", { "STATES", e->system->states }, { "OVER", steps_of_series(e) },
		   { "STEPPED", batch_stepped_rows(e) }, { "OUTPUTS", e->model->outputs },
		   { "SHARED", b.shared }, { "LANES", b.lanes }, { "OPENCL", opencl }, { "CUDA", cuda },
		   { "FLUSHES", e->step->linear.flush != NULL });
	say(e, "#include \"kernel.h\"\n");
	say(e, "%s", openmp ? "#pragma omp declare target\n" : "");
	if (has_series(e))
		emit_kernel_of_series(&b);
	else
		emit_lanes_step(&b);
	emit_lanes_out(&b);
	say(e, "%s", openmp ? "#pragma omp end declare target\n" : "");
}
