import { fileURLToPath } from "node:url";
import { svelte } from "@sveltejs/vite-plugin-svelte";
import { defineConfig } from "vitest/config";

const src = fileURLToPath(new URL("./src", import.meta.url));

export default defineConfig({
  plugins: [svelte()],
  // Addresses relative to the files: the server may stand under any path of a proxy.
  base: "./",
  resolve: { alias: { $: src } },
  build: {
    target: "es2022",
    // The policy of the pages allows no data: in scripts and styles; small files stay files.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    manifest: "manifest.json",
    // One style sheet and one file of what pages share: the first page took 21 requests, one after
    // another where a file names the next.
    cssCodeSplit: false,
    rolldownOptions: {
      checks: { pluginTimings: false },
      output: {
        codeSplitting: {
          groups: [
            {
              name: "shared",
              test: /src\/(api|core|motion|shell|ui)\/|node_modules\/(svelte|openapi-fetch|esm-env|clsx)\//,
              minShareCount: 1,
            },
            { name: "gallery", test: /src\/pages\/gallery\// },
          ],
        },
      },
    },
    // three.js, which is loaded with the player.
    chunkSizeWarningLimit: 600,
  },
  test: { include: ["src/**/*.test.ts"], environment: "node" },
});
