// What the same houses cost as GLB tiles compressed with meshopt: the peer of packets of levels 1 and 2.
//
//     veduta-bake export scenes/old_prague --by-cell -o tiles
//     npm install @gltf-transform/core@4 @gltf-transform/extensions@4 @gltf-transform/functions@4 meshoptimizer
//     node tiles.mjs tiles
//
// In the peer's favour: textures, names and ids are taken away, meshes of one material are joined, and vertices are welded and quantised.

import fs from 'node:fs';
import zlib from 'node:zlib';
import { Logger, NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { dedup, flatten, join, meshopt, prune, weld } from '@gltf-transform/functions';
import { MeshoptDecoder, MeshoptEncoder } from 'meshoptimizer';

const dir = process.argv[2] ?? 'tiles';
await MeshoptEncoder.ready;
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS);
io.registerDependencies({ 'meshopt.encoder': MeshoptEncoder, 'meshopt.decoder': MeshoptDecoder });

const sum = { tiles: 0, triangles: 0, exported: 0, meshopt: 0, meshopt_brotli: 0 };
for (const name of fs.readdirSync(dir).filter((name) => name.endsWith('.glb'))) {
    const tile = await io.read(`${dir}/${name}`);
    tile.setLogger(new Logger(Logger.Verbosity.SILENT));
    const root = tile.getRoot();
    root.listTextures().forEach((texture) => texture.dispose());
    for (const named of [...root.listNodes(), ...root.listMeshes(), ...root.listMaterials()]) {
        named.setName('').setExtras({});
    }
    for (const primitive of root.listMeshes().flatMap((mesh) => mesh.listPrimitives())) {
        sum.triangles += (primitive.getIndices()?.getCount() ?? 0) / 3;
    }
    await tile.transform(dedup(), flatten(), join(), weld(), prune(), meshopt({ encoder: MeshoptEncoder, level: 'high' }));
    const bytes = await io.writeBinary(tile);
    sum.tiles += 1;
    sum.exported += fs.statSync(`${dir}/${name}`).size;
    sum.meshopt += bytes.byteLength;
    sum.meshopt_brotli += zlib.brotliCompressSync(bytes).length;
}
console.log(JSON.stringify(sum));
