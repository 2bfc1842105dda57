return été
