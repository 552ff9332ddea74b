/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps of lanes on a device: NAME_kernel by OpenCL, whose bits are those of NAME_batch. The process has one device, a
 * graphics processor before others, of several the one that its number on this machine falls to; runs take turns. */
#include "plrun.h"

#include <stdlib.h>
#include <string.h>

#ifdef HAVE_OPENCL
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

enum { MOST_DEVICES = 64, ARRAYS = 5 };         /* y, factors, now, peak, sum, as the kernel takes them */

static struct {
	pthread_mutex_t busy;
	cl_device_id id;
	cl_context context;
	cl_command_queue queue;
	char *error;                            /* why there is none */
	bool tried;
} device = { .busy = PTHREAD_MUTEX_INITIALIZER };

struct kernel {
	cl_program program;
	cl_kernel function;
};

static bool has_doubles(cl_device_id id)
{
	cl_device_fp_config config = 0;
	return clGetDeviceInfo(id, CL_DEVICE_DOUBLE_FP_CONFIG, sizeof config, &config, NULL) == CL_SUCCESS &&
	       (config & CL_FP_DENORM) && (config & CL_FP_ROUND_TO_NEAREST);
}

/* Those of one kind, with numbers as a host has them */
static cl_uint find_devices(cl_device_type type, cl_device_id found[MOST_DEVICES])
{
	cl_platform_id platform[16];
	cl_device_id some[MOST_DEVICES];
	cl_uint platforms = 0, count = 0, there;
	if (clGetPlatformIDs(16, platform, &platforms) != CL_SUCCESS)
		return 0;
	for (cl_uint p = 0; p < platforms && p < 16; p++) {
		there = 0;
		if (clGetDeviceIDs(platform[p], type, MOST_DEVICES, some, &there) != CL_SUCCESS)
			continue;
		for (cl_uint i = 0; i < there && i < MOST_DEVICES && count < MOST_DEVICES; i++)
			if (has_doubles(some[i]))
				found[count++] = some[i];
	}
	return count;
}

static void device_open(void)
{
	const char *rank = getenv("OMPI_COMM_WORLD_LOCAL_RANK");
	cl_device_id found[MOST_DEVICES];
	cl_uint count = find_devices(CL_DEVICE_TYPE_GPU, found);
	cl_int failed = CL_SUCCESS;
	if (count == 0)
		count = find_devices(CL_DEVICE_TYPE_ALL, found);
	device.tried = true;
	if (count == 0) {
		device.error = format("OpenCL has no device with doubles on this machine");
		return;
	}
	device.id = found[rank ? strtoul(rank, NULL, 10) % count : 0];
	device.context = clCreateContext(NULL, 1, &device.id, NULL, NULL, &failed);
	if (failed == CL_SUCCESS)
		device.queue = clCreateCommandQueue(device.context, device.id, 0, &failed);
	if (failed != CL_SUCCESS)
		device.error = format("OpenCL cannot use its device: error %d", (int)failed);
}

/* C as of NAME_step has pointers to constants and to its own memory: of a processor they are alike. */
static const char *words_for(cl_device_id id)
{
	char version[100] = "";
	cl_device_type type = 0;
	clGetDeviceInfo(id, CL_DEVICE_VERSION, sizeof version - 1, version, NULL);
	clGetDeviceInfo(id, CL_DEVICE_TYPE, sizeof type, &type, NULL);
	const char *standard = strncmp(version, "OpenCL 3", 8) == 0 ? "-cl-std=CL3.0"
			       : strncmp(version, "OpenCL 2", 8) == 0 ? "-cl-std=CL2.0" : "";
	return format("%s%s", standard, type & CL_DEVICE_TYPE_CPU ? "" : " -DPL_POINTERS_APART");
}

static char *build(struct kernel *k, const char *text, const char *name)
{
	cl_int failed;
	char said[400] = "";
	k->program = clCreateProgramWithSource(device.context, 1, &text, NULL, &failed);
	if (failed == CL_SUCCESS)
		failed = clBuildProgram(k->program, 1, &device.id, words_for(device.id), NULL, NULL);
	if (failed == CL_SUCCESS)
		k->function = clCreateKernel(k->program, format("%s_kernel", name), &failed);
	if (failed == CL_SUCCESS)
		return NULL;
	if (k->program)
		clGetProgramBuildInfo(k->program, device.id, CL_PROGRAM_BUILD_LOG, sizeof said - 1, said, NULL);
	return format("OpenCL could not make a program of the model: error %d %s", (int)failed, said);
}

struct kernel *kernel_of(const char *text, const char *name, char **error)
{
	struct kernel *k = need(calloc(1, sizeof *k));
	pthread_mutex_lock(&device.busy);
	if (!device.tried)
		device_open();
	*error = device.error ? device.error : build(k, text, name);
	pthread_mutex_unlock(&device.busy);
	if (*error) {
		kernel_free(k);
		return NULL;
	}
	return k;
}

void kernel_free(struct kernel *k)
{
	if (k && k->function)
		clReleaseKernel(k->function);
	if (k && k->program)
		clReleaseProgram(k->program);
	free(k);
}

struct course {                         /* of a batch on the device */
	const struct kernel *kernel;
	const struct batch_arrays *from;
	cl_mem memory[ARRAYS];
	cl_int failed;                          /* the first that went wrong */
};

static void take(struct course *c, cl_int result)
{
	c->failed = c->failed == CL_SUCCESS ? result : c->failed;
}

static cl_mem memory_of(struct course *c, size_t numbers, const double *from)
{
	cl_int failed;
	cl_mem memory = clCreateBuffer(device.context, CL_MEM_READ_WRITE, (numbers + 1) * sizeof *from, NULL, &failed);
	take(c, failed);
	if (c->failed == CL_SUCCESS && from && numbers)
		take(c, clEnqueueWriteBuffer(device.queue, memory, CL_TRUE, 0, numbers * sizeof *from, from, 0, NULL,
					     NULL));
	return memory;
}

static void begin(struct course *c)
{
	const struct batch_arrays *a = c->from;
	const cl_ulong count = a->count;
	const size_t numbers[ARRAYS] = { a->rows * count, a->factors * count, (STEPS_ON_DEVICE + 1) * a->shared,
					 a->outputs * count, 4 * a->outputs * count };
	const double *from[ARRAYS] = { a->y, a->factor, NULL, a->peak, a->sum };
	take(c, clSetKernelArg(c->kernel->function, 0, sizeof count, &count));
	for (cl_uint i = 0; i < ARRAYS; i++) {
		c->memory[i] = memory_of(c, numbers[i], from[i]);
		if (c->failed == CL_SUCCESS)
			take(c, clSetKernelArg(c->kernel->function, 3 + i, sizeof c->memory[i], &c->memory[i]));
	}
}

static void take_steps(struct course *c, uint64_t taken, size_t n, const double *now)
{
	const cl_ulong number[] = { taken, n };
	const size_t count = c->from->count, numbers = (n + 1) * c->from->shared;
	for (cl_uint i = 0; i < 2 && c->failed == CL_SUCCESS; i++)
		take(c, clSetKernelArg(c->kernel->function, 1 + i, sizeof number[i], &number[i]));
	if (c->failed == CL_SUCCESS && numbers)
		take(c, clEnqueueWriteBuffer(device.queue, c->memory[2], CL_TRUE, 0, numbers * sizeof *now, now, 0,
					     NULL, NULL));
	if (c->failed == CL_SUCCESS)
		take(c, clEnqueueNDRangeKernel(device.queue, c->kernel->function, 1, NULL, &count, NULL, 0, NULL,
					       NULL));
}

static void end(struct course *c)
{
	const struct batch_arrays *a = c->from;
	double *const to[ARRAYS] = { a->y, NULL, NULL, a->peak, a->sum };
	const size_t numbers[ARRAYS] = { a->rows * a->count, 0, 0, a->outputs * a->count, 4 * a->outputs * a->count };
	for (int i = 0; i < ARRAYS; i++) {
		if (to[i] && c->failed == CL_SUCCESS)
			take(c, clEnqueueReadBuffer(device.queue, c->memory[i], CL_TRUE, 0, numbers[i] * sizeof *to[i],
						    to[i], 0, NULL, NULL));
		if (c->memory[i])
			clReleaseMemObject(c->memory[i]);
	}
}

char *kernel_run(const struct kernel *k, const struct batch_arrays *a, uint64_t steps, shared_rows *share, void *who)
{
	struct course c = { .kernel = k, .from = a };
	double *now = need(calloc((STEPS_ON_DEVICE + 1) * a->shared + 1, sizeof *now));
	pthread_mutex_lock(&device.busy);
	begin(&c);
	for (uint64_t taken = 0; taken < steps && c.failed == CL_SUCCESS;) {
		const size_t n = steps - taken < STEPS_ON_DEVICE ? (size_t)(steps - taken) : STEPS_ON_DEVICE;
		share(who, n, now);
		take_steps(&c, taken, n, now);
		taken += n;
	}
	end(&c);
	pthread_mutex_unlock(&device.busy);
	free(now);
	return c.failed == CL_SUCCESS ? NULL : format("OpenCL has failed: error %d", (int)c.failed);
}

#else

struct kernel *kernel_of(const char *text, const char *name, char **error)
{
	(void)text, (void)name;
	*error = format("this plrun was built without OpenCL");
	return NULL;
}

void kernel_free(struct kernel *k)
{
	(void)k;
}

char *kernel_run(const struct kernel *k, const struct batch_arrays *a, uint64_t steps, shared_rows *share, void *who)
{
	(void)k, (void)a, (void)steps, (void)share, (void)who;
	return format("this plrun was built without OpenCL");
}

#endif
