// Results of the checks.
import fs from 'node:fs';

export const failures = [];
export function check(what, isRight, seen) {
    console.log(`${isRight ? 'ok    ' : 'FAILED'} ${what}: ${seen}`);
    if (!isRight) failures.push(what);
}

export function endOfChecks() {
    if (failures.length === 0) return;
    console.log(`${failures.length} of the checks failed`);
    process.exit(1);
}

/** Folders whose names begin so. */
export function folders(prefix) {
    const isFolder = name => fs.statSync(name).isDirectory();
    return fs.readdirSync('.').filter(name => name.startsWith(prefix) && isFolder(name)).sort();
}
