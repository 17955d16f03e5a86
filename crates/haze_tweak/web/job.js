// Runs one job of the tweaker beside the page: the same program, without a window.
onmessage = async ({ data: { program, module, name, job, files } }) => {
    try {
        const haze = await import(program);
        await haze.default({ module_or_path: module });
        postMessage({ output: haze.run_job(name, job, files, (steps) => postMessage({ steps })) });
    } catch (error) {
        console.error(error);
        // Without an output: the job has failed.
        postMessage({});
    }
};
