import { mount } from "svelte";
import App from "./App.svelte";
import { router } from "./core/router.svelte";
import { theme } from "./core/theme.svelte";
import "./styles/tokens.css";
import "./styles/base.css";

const target = document.getElementById("app");
if (!target) throw new Error("The page has no place for the application.");
theme.start();
router.start();
mount(App, { target });
